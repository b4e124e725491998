/* SPDX-License-Identifier: Apache-2.0 */
/* core/text/number.h against strtof, which rounds correctly: the same bits for every number. */
#include "testing.h"

#include "core/base/random.h"
#include "core/text/number.h"

static void assert_like_strtof(const char *text) {
    float value = 0;
    const float expected = strtof(text, NULL);
    const bool fits = rt_number_float(text, strlen(text), &value);
    if (fits != (bool)isfinite(expected) || (fits && memcmp(&value, &expected, sizeof value) != 0))
        fail_msg("%s: %s%.9g, strtof says %.9g", text, fits ? "" : "refused, ", (double)value,
                 (double)expected);
}

/* The finite float32 of any bits. */
static float any_float(RtRandom *random) {
    for (;;) {
        const uint32_t bits = rt_random_bits(random);
        float value;
        memcpy(&value, &bits, sizeof value);
        if (isfinite(value)) return value;
    }
}

RT_TEST(numbers_at_the_ends_of_the_range_and_odd_notations_are_like_strtof) {
    static const char *const texts[] = {"0",
                                        "-0",
                                        "+0.0",
                                        "0e99999",
                                        "0.0000000000000001",
                                        ".5",
                                        "5.",
                                        "-.5e+1",
                                        "1e-0",
                                        "16777217",
                                        "16777218.99999999999999999999",
                                        "1.000000059604644775390625",
                                        "9007199254740993",
                                        "1.0000000596046447753906250000000000000000000000001",
                                        "1.00000005960464477539062499999999999999",
                                        "3.4028234663852886e38",
                                        "3.4028235677973366e38",
                                        "340282356779733661637539395458142568447.9",
                                        "3.4028235677973367e38",
                                        "1e39",
                                        "-1e999999999999999999999",
                                        "1e-999999999999999999999",
                                        "1.17549435e-38",
                                        "1.1754943157898258e-38",
                                        "1.401298464324817e-45",
                                        "7.006492321624085e-46",
                                        "7.0064923216240853e-46",
                                        "7.0064923216240854e-46",
                                        "1e22",
                                        "1e23",
                                        "1e-22",
                                        "1e-23",
                                        "18446744073709551615",
                                        "18446744073709551616",
                                        "99999999999999999999999999",
                                        "0.000000000000000000000000000000000000000000001e45",
                                        "1000000000000000000000000000000000000000e-39",
                                        "0.30000000000000004",
                                        "123456789012345678901234567890e-30"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) assert_like_strtof(texts[i]);
}

RT_TEST(what_is_no_decimal_number_is_refused) {
    static const char *const texts[] = {"",    ".",   "-",   "+-1", "e5",  "1e",   "1e+", "1.5.", "0x1",
                                        "inf", "nan", "1,5", "1f",  "--1", "1e5.", "1 2", " 1"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        float value;
        if (rt_number_float(texts[i], strlen(texts[i]), &value)) fail_msg("'%s' is accepted", texts[i]);
    }
}

RT_TEST(a_number_ends_where_its_word_does) {
    float value;
    assert_true(rt_number_float("16777217 5", 8, &value) && value == 16777216);
    assert_false(rt_number_float("12 5", 1, &value));
}

RT_TEST(floats_of_any_bits_written_with_any_number_of_digits_are_like_strtof) {
    RtRandom random = rt_random(1, 0);
    char text[128];
    for (int i = 0; i < RT_SHARE(1000000, 50000); i++) {
        snprintf(text, sizeof text, "%.*g", (int)rt_random_below(&random, 24), (double)any_float(&random));
        assert_like_strtof(text);
    }
}

RT_TEST(floats_come_back_from_nine_digits) {
    RtRandom random = rt_random(2, 0);
    char text[32];
    for (int i = 0; i < RT_SHARE(500000, 50000); i++) {
        const float value = any_float(&random);
        float again = 0;
        snprintf(text, sizeof text, "%.9g", (double)value);
        assert_true(rt_number_float(text, strlen(text), &again));
        assert_memory_equal(&again, &value, sizeof value);
    }
}

/* A tie has up to 150 digits. Cut off, or with one more digit behind it, it is a little to one side. */
RT_TEST(ties_between_floats_and_numbers_beside_them_are_like_strtof) {
    RtRandom random = rt_random(3, 0);
    char text[256];
    for (int i = 0; i < RT_SHARE(300000, 20000); i++) {
        const float value = i % 2 ? any_float(&random) : rt_random_between(&random, -1000, 1000);
        const double tie = ((double)value + (double)nextafterf(value, 0)) / 2;
        const int digits = 15 + (int)rt_random_below(&random, 135);
        snprintf(text, sizeof text, i % 3 ? "%.*e" : "%.*f", digits, tie);
        assert_like_strtof(text);
        char tail[8] = ""; /* the exponent: a digit goes in front of it */
        char *exponent = strchr(text, 'e');
        if (exponent) snprintf(tail, sizeof tail, "%s", exponent);
        snprintf(exponent ? exponent : text + strlen(text), 16, "1%s", tail);
        assert_like_strtof(text);
    }
}

RT_TEST(digits_points_and_exponents_at_random_are_like_strtof) {
    RtRandom random = rt_random(4, 0);
    char text[128];
    for (int i = 0; i < RT_SHARE(1000000, 50000); i++) {
        const uint32_t digits = 1 + rt_random_below(&random, 25), point = rt_random_below(&random, 30);
        size_t length = 0;
        if (rt_random_below(&random, 2)) text[length++] = '-';
        for (uint32_t k = 0; k < digits; k++) {
            if (k == point) text[length++] = '.';
            text[length++] = (char)('0' + rt_random_below(&random, 10));
        }
        text[length] = 0;
        if (rt_random_below(&random, 2))
            snprintf(text + length, sizeof text - length, "e%d", (int)rt_random_below(&random, 110) - 60);
        assert_like_strtof(text);
    }
}

RT_TESTS(number, NULL, NULL)
