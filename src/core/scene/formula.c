/* SPDX-License-Identifier: Apache-2.0 */
#include "core/scene/formula.h"

#include "core/base/memory.h"

#include <stdio.h>
#include <string.h>

enum { OPEN = '(' };

static const char signs[] = {[RT_CSG_UNION] = '|', [RT_CSG_INTERSECTION] = '&', [RT_CSG_DIFFERENCE] = '-'};

typedef struct Parser {
    const char *text;
    size_t at; /* next character */
    RtCsgBuilder *builder;
    RtFormulaLookup *lookup;
    void *context;
    uint32_t term_count, term_capacity;
    RtCsgTerm *terms; /* operands that await their operator */
    uint32_t operator_count, operator_capacity;
    char *operators; /* '|', '&', '-' and OPEN that await their right operand */
    RtError *error;
} Parser;

static bool starts_name(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static bool continues_name(char c) {
    return starts_name(c) || (c >= '0' && c <= '9');
}

static size_t name_length(const char *text) {
    size_t length = 0;
    if (!starts_name(*text)) return 0;
    while (continues_name(text[length])) length++;
    return length;
}

bool rt_formula_is_name(const char *name) {
    size_t length = name_length(name);
    return length > 0 && length < RT_FORMULA_MAX_NAME && name[length] == '\0';
}

static RtStatus fail(Parser *p, const char *what) {
    return rt_fail(p->error, RT_BAD_INPUT, "at character %zu of the formula '%.60s%s': %s", p->at + 1,
                   p->text, strlen(p->text) > 60 ? "..." : "", what);
}

/* ---- the stacks ---- */

static RtStatus push_operator(Parser *p, char c) {
    return rt_append(&p->operators, &p->operator_count, &p->operator_capacity, &c, 1, p->error);
}

static int rank(char c) {
    return c == OPEN ? 0 : c == '&' ? 2 : 1;
}

/* Applies the operators on the stack down to precedence `least`. */
static RtStatus reduce(Parser *p, int least) {
    while (p->operator_count > 0 && rank(p->operators[p->operator_count - 1]) >= least) {
        char c = p->operators[--p->operator_count];
        RtCsgOp op = c == '|' ? RT_CSG_UNION : c == '&' ? RT_CSG_INTERSECTION : RT_CSG_DIFFERENCE;
        RtCsgTerm right = p->terms[--p->term_count], left = p->terms[p->term_count - 1];
        RT_TRY(rt_csg_combine(p->builder, op, left, right, &p->terms[p->term_count - 1], p->error));
    }
    return RT_OK;
}

/* ---- reading ---- */

static RtStatus read_operand(Parser *p, bool *done) {
    const char *here = p->text + p->at;
    size_t length = name_length(here);
    *done = false;
    if (*here == '(') {
        p->at++;
        return push_operator(p, OPEN);
    }
    if (length == 0)
        return fail(p, *here == '\0' ? "it ends where a name or '(' is expected" : "expected a name or '('");
    if (length >= RT_FORMULA_MAX_NAME) return fail(p, "this name is too long");
    char name[RT_FORMULA_MAX_NAME];
    memcpy(name, here, length);
    name[length] = '\0';
    RtCsgTerm term;
    RT_TRY(p->lookup(p->context, name, &term, p->error));
    p->at += length;
    *done = true;
    return rt_append(&p->terms, &p->term_count, &p->term_capacity, &term, sizeof term, p->error);
}

/* Reads what may follow an operand: an operator or ')'. */
static RtStatus read_operator(Parser *p, bool *operand_next) {
    char c = p->text[p->at];
    *operand_next = false;
    if (c == ')') {
        RT_TRY(reduce(p, 1));
        if (p->operator_count == 0) return fail(p, "this ')' has no '(' before it");
        p->operator_count--;
        p->at++;
        return RT_OK;
    }
    if (c != '|' && c != '&' && c != '-')
        return fail(p, "expected | (union), & (intersection), - (difference) or ')'");
    RT_TRY(reduce(p, rank(c)));
    p->at++;
    *operand_next = true;
    return push_operator(p, c);
}

static RtStatus read_all(Parser *p, RtCsgTerm *term) {
    bool operand_next = true;
    for (;;) {
        p->at += strspn(p->text + p->at, " \t\n");
        if (operand_next) {
            bool done;
            RT_TRY(read_operand(p, &done));
            operand_next = !done;
        } else if (p->text[p->at] != '\0') {
            RT_TRY(read_operator(p, &operand_next));
        } else {
            RT_TRY(reduce(p, 1));
            if (p->operator_count > 0) return fail(p, "a ')' is missing");
            *term = p->terms[0];
            return RT_OK;
        }
    }
}

RtStatus rt_formula_read(const char *formula, RtCsgBuilder *builder, RtFormulaLookup *lookup, void *context,
                         RtCsgTerm *term, RtError *error) {
    Parser p = {.text = formula, .builder = builder, .lookup = lookup, .context = context, .error = error};
    RtStatus status = read_all(&p, term);
    rt_free(p.terms);
    rt_free(p.operators);
    return status;
}

/* ---- writing ---- */

enum { LEAF = 0 };

/* A node of the tree, made by an instruction. */
typedef struct Branch {
    char sign;            /* an operator, or LEAF */
    uint32_t left, right; /* branches; in a leaf `left` is the solid */
} Branch;

/* Still to be written, last first: a branch, or a character if `branch` is NOTHING. */
#define NOTHING UINT32_MAX
typedef struct Pending {
    uint32_t branch;
    char character;
} Pending;

typedef struct Writer {
    const RtCsgForest *forest;
    const RtCsg *tree;
    Branch *branches; /* [2 * solids] */
    uint32_t *stack;  /* [solids] */
    uint32_t pending_count, pending_capacity;
    Pending *pending;
    uint32_t length, capacity;
    char *text;
    RtError *error;
} Writer;

/* Runs the program on branches instead of lists; returns the root. */
static uint32_t grow(Writer *w) {
    uint32_t count = 0, height = 0;
    for (uint32_t i = 0; i < w->tree->count; i++) {
        RtCsgInstruction step = w->forest->instructions[w->tree->first + i];
        if (step.code == RT_CSG_PUSH) {
            w->branches[count] = (Branch){LEAF, step.operand, 0};
        } else if (step.code == RT_CSG_APPLY) {
            uint32_t top = w->stack[--height], lower = w->stack[--height];
            w->branches[count] =
                (Branch){signs[step.operand], step.reversed ? top : lower, step.reversed ? lower : top};
        } else {
            continue;
        }
        w->stack[height++] = count++;
    }
    return w->stack[0];
}

static RtStatus put(Writer *w, const char *text) {
    uint32_t length = (uint32_t)strlen(text);
    RT_TRY(rt_reserve(&w->text, &w->capacity, (uint64_t)w->length + length + 1, 1, w->error));
    memcpy(w->text + w->length, text, length + 1);
    w->length += length;
    return RT_OK;
}

static RtStatus push(Writer *w, uint32_t branch, char character) {
    const Pending next = {branch, character};
    return rt_append(&w->pending, &w->pending_count, &w->pending_capacity, &next, sizeof next, w->error);
}

/* In reverse: the stack is written from its top. */
static RtStatus push_operand(Writer *w, uint32_t branch, bool enclosed) {
    if (enclosed) RT_TRY(push(w, NOTHING, ')'));
    RT_TRY(push(w, branch, 0));
    return enclosed ? push(w, NOTHING, '(') : RT_OK;
}

static RtStatus write_branch(Writer *w, const Branch *branch) {
    char name[16];
    if (branch->sign == LEAF) {
        snprintf(name, sizeof name, "s%u", branch->left);
        return put(w, name);
    }
    char left = w->branches[branch->left].sign;
    RT_TRY(push_operand(w, branch->right, w->branches[branch->right].sign != LEAF));
    RT_TRY(push(w, NOTHING, ' '));
    RT_TRY(push(w, NOTHING, branch->sign));
    RT_TRY(push(w, NOTHING, ' '));
    return push_operand(w, branch->left, left != LEAF && rank(left) < rank(branch->sign));
}

static RtStatus write_all(Writer *w) {
    RT_TRY(push(w, grow(w), 0));
    while (w->pending_count > 0) {
        Pending next = w->pending[--w->pending_count];
        if (next.branch == NOTHING)
            RT_TRY(put(w, (char[]){next.character, '\0'}));
        else
            RT_TRY(write_branch(w, &w->branches[next.branch]));
    }
    return RT_OK;
}

RtStatus rt_formula_write(const RtCsgForest *forest, const RtCsg *tree, char **formula, RtError *error) {
    size_t solids = tree->solid_count;
    Writer w = {.forest = forest,
                .tree = tree,
                .branches = rt_alloc(2 * solids, sizeof(Branch)),
                .stack = rt_alloc(solids, sizeof(uint32_t)),
                .error = error};
    RtStatus status = w.branches && w.stack ? write_all(&w)
                                            : rt_fail_memory(error, "a formula", 2 * solids * sizeof(Branch));
    rt_free(w.branches);
    rt_free(w.stack);
    rt_free(w.pending);
    *formula = w.text;
    if (status == RT_OK) return RT_OK;
    rt_free(w.text);
    *formula = NULL;
    return status;
}
