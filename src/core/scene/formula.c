/* SPDX-License-Identifier: Apache-2.0 */
#include "core/scene/formula.h"

#include "core/base/file.h"
#include "core/base/memory.h"

#include <stdio.h>
#include <string.h>

enum { OPEN = '(' };

static const char signs[] = {[RT_CSG_UNION] = '|', [RT_CSG_INTERSECTION] = '&', [RT_CSG_DIFFERENCE] = '-'};

static int rank(char c) {
    return c == OPEN ? 0 : c == '&' ? 2 : 1;
}

typedef struct Parser {
    const char *text;
    size_t at; /* next character */
    RtCsgBuilder *builder;
    RtFormulaLookup *lookup;
    void *context;
    RtCsgTerm *terms; /* operands that await their operator; there is room for all of the text */
    char *operators;  /* '|', '&', '-' and OPEN that await their right operand; likewise */
    size_t term_count, operator_count;
    RtError *error;
} Parser;

static bool starts_name(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static size_t name_length(const char *text) {
    size_t length = 0;
    if (!starts_name(*text)) return 0;
    while (starts_name(text[length]) || (text[length] >= '0' && text[length] <= '9')) length++;
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

/* ---- reading ---- */

/* Applies the operators on the stack down to precedence `least`. */
static RtStatus reduce(Parser *p, int least) {
    while (p->operator_count > 0 && rank(p->operators[p->operator_count - 1]) >= least) {
        char c = p->operators[--p->operator_count];
        RtCsgOp op = c == '|' ? RT_CSG_UNION : c == '&' ? RT_CSG_INTERSECTION : RT_CSG_DIFFERENCE;
        RtCsgTerm right = p->terms[--p->term_count], *left = &p->terms[p->term_count - 1];
        RT_TRY(rt_csg_combine(p->builder, op, *left, right, left, p->error));
    }
    return RT_OK;
}

static RtStatus read_operand(Parser *p, bool *done) {
    const char *here = p->text + p->at;
    const size_t length = name_length(here);
    *done = *here != OPEN;
    if (*here == OPEN) {
        p->at++;
        p->operators[p->operator_count++] = OPEN;
        return RT_OK;
    }
    if (length == 0)
        return fail(p, *here == '\0' ? "it ends where a name or '(' is expected" : "expected a name or '('");
    if (length >= RT_FORMULA_MAX_NAME) return fail(p, "this name is too long");
    char name[RT_FORMULA_MAX_NAME] = "";
    memcpy(name, here, length);
    RT_TRY(p->lookup(p->context, name, &p->terms[p->term_count], p->error));
    p->term_count++;
    p->at += length;
    return RT_OK;
}

/* Reads what may follow an operand: an operator or ')'. */
static RtStatus read_operator(Parser *p, bool *operand_next) {
    char c = p->text[p->at];
    *operand_next = c != ')';
    if (c != '|' && c != '&' && c != '-' && c != ')')
        return fail(p, "expected | (union), & (intersection), - (difference) or ')'");
    RT_TRY(reduce(p, c == ')' ? 1 : rank(c)));
    if (c != ')')
        p->operators[p->operator_count++] = c;
    else if (p->operator_count-- == 0)
        return fail(p, "this ')' has no '(' before it");
    p->at++;
    return RT_OK;
}

RtStatus rt_formula_read(const char *formula, RtCsgBuilder *builder, RtFormulaLookup *lookup, void *context,
                         RtCsgTerm *term, RtError *error) {
    RT_ARENA(memory);
    const size_t length = strlen(formula);
    Parser p = {.text = formula,
                .builder = builder,
                .lookup = lookup,
                .context = context,
                .terms = rt_arena_alloc_unset(&memory, length / 2 + 1, sizeof(RtCsgTerm)),
                .operators = rt_arena_alloc_unset(&memory, length, 1),
                .error = error};
    RT_TRY(rt_arena_check(&memory, "a formula", error));
    for (bool operand_next = true, done;;) {
        p.at += strspn(formula + p.at, " \t\n");
        if (operand_next) {
            RT_TRY(read_operand(&p, &done));
            operand_next = !done;
        } else if (formula[p.at] != '\0') {
            RT_TRY(read_operator(&p, &operand_next));
        } else {
            RT_TRY(reduce(&p, 1));
            if (p.operator_count > 0) return fail(&p, "a ')' is missing");
            *term = p.terms[0];
            return RT_OK;
        }
    }
}

/* ---- writing ---- */

enum { LEAF = 0 };

/* A node of the tree, made by an instruction. */
typedef struct Branch {
    char sign;            /* an operator, or LEAF */
    uint32_t left, right; /* branches; in a leaf `left` is the solid */
} Branch;

/* Runs the program on branches instead of lists; returns the root. `stack` has room for all solids. */
static uint32_t grow(const RtCsgForest *forest, const RtCsg *tree, Branch *branches, uint32_t *stack) {
    uint32_t count = 0, height = 0;
    for (uint32_t i = 0; i < tree->count; i++) {
        RtCsgInstruction step = forest->instructions[tree->first + i];
        if (step.code == RT_CSG_PUSH) {
            branches[count] = (Branch){LEAF, step.operand, 0};
        } else if (step.code == RT_CSG_APPLY) {
            uint32_t top = stack[--height], lower = stack[--height];
            branches[count] =
                (Branch){signs[step.operand], step.reversed ? top : lower, step.reversed ? lower : top};
        } else {
            continue;
        }
        stack[height++] = count++;
    }
    return stack[0];
}

/* Still to be written, last first: branches, and characters from CHARACTER on. A branch becomes at most nine.
 */
enum { CHARACTER = 1 << 30, MOST_PUSHED = 9 };
_Static_assert(2 * RT_CSG_MAX_SOLIDS <= CHARACTER, "a branch is no character");

static uint32_t *push_operand(uint32_t *top, uint32_t branch, bool enclosed) {
    if (enclosed) *top++ = CHARACTER + ')';
    *top++ = branch;
    if (enclosed) *top++ = CHARACTER + OPEN;
    return top;
}

static void write_branches(const Branch *branches, uint32_t root, uint32_t first, uint32_t *pending,
                           FILE *out) {
    uint32_t *top = push_operand(pending, root, false);
    while (top > pending) {
        const uint32_t next = *--top;
        if (next >= CHARACTER) {
            fputc((int)(next - CHARACTER), out);
            continue;
        }
        const Branch *branch = &branches[next];
        if (branch->sign == LEAF) {
            fprintf(out, "s%u", first + branch->left);
            continue;
        }
        const char left = branches[branch->left].sign;
        top = push_operand(top, branch->right, branches[branch->right].sign != LEAF);
        *top++ = CHARACTER + ' ';
        *top++ = CHARACTER + (uint32_t)branch->sign;
        *top++ = CHARACTER + ' ';
        top = push_operand(top, branch->left, left != LEAF && rank(left) < rank(branch->sign));
    }
}

RtStatus rt_formula_write(const RtCsgForest *forest, const RtCsg *tree, uint32_t first, char **formula,
                          RtError *error) {
    RT_ARENA(memory);
    const size_t solids = tree->solid_count;
    Branch *branches = rt_arena_alloc_unset(&memory, 2 * solids, sizeof *branches);
    uint32_t *stack = rt_arena_alloc_unset(&memory, MOST_PUSHED * solids, sizeof *stack);
    RtMemoryFile text;
    *formula = NULL;
    RT_TRY(rt_arena_check(&memory, "a formula", error));
    RT_TRY(rt_memory_file_open(&text, error));
    write_branches(branches, grow(forest, tree, branches, stack), first, stack, text.file);
    RT_TRY(rt_memory_file_close(&text, "a formula", error));
    *formula = text.data;
    return RT_OK;
}
