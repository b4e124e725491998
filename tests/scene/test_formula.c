/* SPDX-License-Identifier: Apache-2.0 */
/* Formulas of CSG trees: their meaning, and the messages about invalid ones. */
#include "core/scene/formula.h"
#include "testing.h"

/* Solids are called a to z; the term of each is made when it is named. */
static RtStatus look_up(void *context, const char *name, RtCsgTerm *term, RtError *error) {
    RtCsgBuilder *builder = context;
    if (strlen(name) > 1) return rt_fail(error, RT_BAD_INPUT, "there is no solid '%s'", name);
    return rt_csg_solid(builder, (uint32_t)(name[0] - 'a'), 0, term, error);
}

/* Fully parenthesised, by recursion: the formulas of this test are short. */
static void print(const RtCsgBuilder *builder, RtCsgTerm term, char *out) {
    static const char signs[] = {
        [RT_CSG_UNION] = '|', [RT_CSG_INTERSECTION] = '&', [RT_CSG_DIFFERENCE] = '-'};
    const RtCsgNode *node = &builder->nodes[term];
    if (node->kind == RT_CSG_SOLID) {
        sprintf(out + strlen(out), "%c", (char)('a' + node->left));
        return;
    }
    strcat(out, "(");
    print(builder, node->left, out);
    sprintf(out + strlen(out), "%c", signs[node->op]);
    print(builder, node->right, out);
    strcat(out, ")");
}

static void fill(RtCsgBuilder *builder) {
    RtTransform here = rt_transform_identity();
    uint32_t index;
    for (int i = 0; i < 26; i++) assert_ok(rt_solid_add_sphere(&builder->set, &here, &index, error));
}

/* The solids a..z must stand in the set for their terms to be made. */
#define OWNED_LETTERS(builder)                                                                               \
    OWNED_BUILDER builder = {0};                                                                             \
    RtCsgTerm term;                                                                                          \
    fill(&(builder))

static void expect(const char *formula, const char *meaning) {
    char text[256] = "";
    OWNED_LETTERS(builder);
    assert_ok(rt_formula_read(formula, &builder, look_up, &builder, &term, error));
    print(&builder, term, text);
    assert_string_equal(text, meaning);
}

static void expect_complaint(const char *formula, const char *complaint) {
    OWNED_LETTERS(builder);
    assert_bad_input(rt_formula_read(formula, &builder, look_up, &builder, &term, error), complaint);
}

RT_TEST(operators_are_taken_from_the_left) {
    expect("a", "a");
    expect("a - b - c", "((a-b)-c)");
    expect("a|b - c|d", "(((a|b)-c)|d)");
    expect("a & b & c", "((a&b)&c)");
}

RT_TEST(intersection_binds_before_the_others) {
    expect("a | b & c", "(a|(b&c))");
    expect("a & b | c & d", "((a&b)|(c&d))");
    expect("a - b & c - d", "((a-(b&c))-d)");
}

RT_TEST(parentheses_come_first) {
    expect("(a | b) & c", "((a|b)&c)");
    expect("a - (b - (c - d))", "(a-(b-(c-d)))");
    expect("  ( ( a ) )\t", "a");
}

RT_TEST(mistakes_are_placed_at_their_character) {
    expect_complaint("", "at character 1");
    expect_complaint("a -", "at character 4");
    expect_complaint("a b", "at character 3");
    expect_complaint("a | * b", "at character 5");
    expect_complaint("(a - b", "a ')' is missing");
    expect_complaint("a - b)", "at character 6");
    expect_complaint("()", "at character 2");
    expect_complaint("a + b", "expected | (union), & (intersection), - (difference)");
    expect_complaint("a - who", "there is no solid 'who'");
}

RT_TEST(formulas_nest_as_deeply_as_memory_allows) {
    enum { DEPTH = 100000 };
    OWNED_LETTERS(builder);
    char *formula = test_malloc(4 * DEPTH + 2);
    for (int i = 0; i < DEPTH; i++) memcpy(formula + 3 * i, "a-(", 3);
    formula[3 * DEPTH] = 'b';
    memset(formula + 3 * DEPTH + 1, ')', DEPTH);
    formula[4 * DEPTH + 1] = '\0';
    assert_ok(rt_formula_read(formula, &builder, look_up, &builder, &term, error));
    assert_int_equal(builder.nodes[term].size, DEPTH + 1);
    test_free(formula);
}

RT_TEST(names_are_letters_digits_and_underscores) {
    assert_true(rt_formula_is_name("a"));
    assert_true(rt_formula_is_name("_bore_2"));
    assert_false(rt_formula_is_name(""));
    assert_false(rt_formula_is_name("2nd"));
    assert_false(rt_formula_is_name("a-b"));
    assert_false(rt_formula_is_name("a b"));
}

RT_TESTS(formula, NULL, NULL)
