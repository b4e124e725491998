/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers of text files, core/text/scanner.h. */
#include "testing.h"

#include "core/text/scanner.h"

#include <string.h>

static bool read_float(const char *text, size_t length, float *out) {
    return rt_scan_float((RtWord){.text = text, .length = length}, out);
}

RT_TEST(numbers_become_the_float_nearest_to_them) {
    static const struct {
        const char *text;
        float value;
    } cases[] = {{"0", 0},
                 {"+.5", 0.5f},
                 {"-5.", -5},
                 {"2.5e-3", 0.0025f},
                 {"0.0000000000000001", 1e-16f},
                 {"16777217", 16777216}, /* a tie: to even */
                 {"1.0000000596046447753906250000000000000000000000001", 0x1.000002p0f},
                 {"1.00000005960464477539062499999999999999", 1},
                 {"3.4028235677973366e38", 0x1.fffffep127f},
                 {"1e-999999999999999999999", 0},
                 {"0.000000000000000000000000000000000000000000001e45", 1}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        float value = -1;
        if (!read_float(cases[i].text, strlen(cases[i].text), &value) || value != cases[i].value)
            fail_msg("%s is read as %.9g", cases[i].text, (double)value);
    }
}

RT_TEST(what_is_no_decimal_number_or_overflows_is_refused) {
    static const char *const texts[] = {"",     ".",   "-",   "+-1",  "e5",    "1e", "1e+",
                                        "1.5.", "0x1", "inf", "nan",  "1,5",   "1f", "--1",
                                        "1e5.", "1 2", " 1",  "1e39", "-1e999"};
    float value;
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        if (read_float(texts[i], strlen(texts[i]), &value)) fail_msg("'%s' is accepted", texts[i]);
    }
}

RT_TEST(a_number_ends_where_its_word_does) {
    float value;
    assert_true(read_float("16777217 5", 8, &value) && value == 16777216);
    assert_false(read_float("12 5", 1, &value));
}

RT_TESTS(scanner, NULL, NULL)
