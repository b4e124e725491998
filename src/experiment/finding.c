/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/finding.h"

#include "experiment/claim.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

/* ---- pieces ---- */

/* text[0..*length) without blanks around it. */
static const char *trim(const char *text, size_t *length) {
    while (*length > 0 && *text == ' ') text++, --*length;
    while (*length > 0 && text[*length - 1] == ' ') --*length;
    return text;
}

/* Where ": " divides text[0..length), or `length`. Labels have colons without a blank. */
static size_t find_colon(const char *text, size_t length) {
    size_t i = 0;
    while (i + 1 < length && !(text[i] == ':' && text[i + 1] == ' ')) i++;
    return i + 1 < length ? i : length;
}

static RtStatus copy(const char *text, size_t length, char *out, size_t size, RtError *error) {
    text = trim(text, &length);
    if (length >= size)
        return rt_fail(error, RT_BAD_INPUT, "{%.40s...}: more than %zu characters", text, size - 1);
    memcpy(out, text, length);
    out[length] = '\0';
    return RT_OK;
}

/* inside[0..length) is what stands between braces. */
static RtStatus read_braces(const char *inside, size_t length, RtFindingPiece *piece, RtError *error) {
    const char *text = trim(inside, &length);
    if (*text == '"') {
        piece->sort = RT_FINDING_LITERAL;
        piece->words = text + 1;
        piece->length = length < 2 ? 0 : (uint32_t)length - 2;
        if (length > 1 && text[length - 1] == '"') return RT_OK;
        return rt_fail(error, RT_BAD_INPUT, "{%.*s}: a quotation mark is missing", (int)length, text);
    }
    if (length > 5 && strncmp(text, "from ", 5) == 0) {
        const size_t colon = find_colon(text, length);
        if (colon == length)
            return rt_fail(error, RT_BAD_INPUT, "{%.*s}: expected {from NAME: ...}", (int)length, text);
        RT_TRY(copy(text + 5, colon - 5, piece->from, sizeof piece->from, error));
        if (strchr(piece->from, '/') || piece->from[0] == '.')
            return rt_fail(error, RT_BAD_INPUT, "'%s' is not the name of an experiment", piece->from);
        text += colon + 1;
        length -= colon + 1;
    }
    const size_t colon = find_colon(text, length);
    piece->sort = colon < length ? RT_FINDING_CLAIM : RT_FINDING_READOUT;
    if (piece->sort == RT_FINDING_READOUT) return copy(text, length, piece->expression, RT_MAX_CLAIM, error);
    size_t words = colon;
    piece->words = trim(text, &words);
    piece->length = (uint32_t)words;
    return copy(text + colon + 1, length - colon - 1, piece->expression, RT_MAX_CLAIM, error);
}

bool rt_finding_next(const char **at, RtFindingPiece *piece, RtError *error) {
    const char *text = *at;
    const size_t plain = strcspn(text, "{}");
    *piece = (RtFindingPiece){.words = text, .length = (uint32_t)plain};
    *at = text + plain;
    if (*text == '\0') return false;
    if (plain > 0) return true;
    const size_t inside = strcspn(text + 1, "{}");
    if (*text != '{' || text[1 + inside] != '}') {
        rt_fail(error, RT_BAD_INPUT, "'%.40s': braces do not match; they cannot be nested", text);
        return false;
    }
    *at = text + inside + 2;
    return read_braces(text + 1, inside, piece, error) == RT_OK;
}

/* ---- words ---- */

/* Takes the next word from *at, before `end`, without punctuation around it. */
static bool next_word(const char **at, const char *end, const char **word, size_t *length) {
    static const char punctuation[] = " \"'`()[]*,.;:!?";
    const char *from = *at;
    while (from < end && strchr(punctuation, *from)) from++;
    const char *to = from;
    while (to < end && *to != ' ') to++;
    *at = to;
    while (to > from && strchr(punctuation, to[-1])) to--;
    *word = from;
    *length = (size_t)(to - from);
    return *length > 0;
}

static bool is_word(const char *word, size_t length, const char *name) {
    return strlen(name) == length && strncasecmp(word, name, length) == 0;
}

static bool is_general(const char *word, size_t length) {
    static const char *const general[] = {"all",        "always",     "best",    "cheapest", "every",
                                          "everything", "everywhere", "fastest", "never",    "none",
                                          "nothing",    "nowhere",    "slowest", "worst"};
    for (size_t i = 0; i < sizeof general / sizeof general[0]; i++) {
        if (is_word(word, length, general[i])) return true;
    }
    return false;
}

/* A figure: not a name (AVX-512), but a power of n is one. */
static bool is_number(const char *word, size_t length) {
    bool digit = false;
    for (size_t i = 0; i < length; i++) digit |= isdigit((unsigned char)word[i]) != 0;
    return digit && (!isalpha((unsigned char)*word) || memchr(word, '^', length));
}

static bool is_year(const char *text, const char *word, size_t length) {
    int open = 0;
    for (const char *c = text; c < word; c++) open += (*c == '(') - (*c == ')');
    return open > 0 && length == 4 && strspn(word, "0123456789") >= 4 &&
           (strncmp(word, "1", 1) == 0 || strncmp(word, "20", 2) == 0);
}

RtStatus rt_finding_check_bound(const char *text, RtError *error) {
    RtFindingPiece piece;
    const char *word;
    size_t length;
    for (const char *at = text; rt_finding_next(&at, &piece, NULL);) {
        const char *in = piece.words;
        if (piece.sort != RT_FINDING_TEXT) continue;
        while (next_word(&in, piece.words + piece.length, &word, &length)) {
            const bool number = is_number(word, length) && !is_year(text, word, length);
            if (!number && !is_general(word, length)) continue;
            return rt_fail(error, RT_BAD_INPUT,
                           "'%.*s' stands outside braces: write %s (experiments/README.md)", (int)length,
                           word,
                           number ? "the figure as an expression, {time of ACCEL on SCENE}, or as {\"TEXT\"}"
                                  : "{WORDS: CLAIM}, a claim over all cells");
        }
    }
    return RT_OK;
}

/* ---- checks ---- */

/* Whether a word is the name, or begins with it and "=" or ":". */
static bool names(const RtFindingPiece *piece, const char *name) {
    const char *word, *in = piece->words;
    const size_t size = strlen(name);
    size_t length;
    while (next_word(&in, piece->words + piece->length, &word, &length)) {
        if (is_word(word, length, name)) return true;
        if (length > size && strncasecmp(word, name, size) == 0 && strchr("=:", word[size])) return true;
    }
    return false;
}

static RtStatus fail_hidden(const RtFindingPiece *piece, const char *place, RtError *error) {
    return rt_fail(error, RT_BAD_INPUT,
                   "the words '%.*s' are general, and the claim is only about '%s': name it in the words, or "
                   "leave it out of the claim '%s'",
                   (int)piece->length, piece->words, place, piece->expression);
}

static RtStatus check_places(const RtFindingPiece *piece, const RtClaimSide *side, RtError *error) {
    if (*side->scene && !names(piece, side->scene)) return fail_hidden(piece, side->scene, error);
    if (!side->each_kind && side->kind != RT_ALL_RAYS && !names(piece, rt_ray_kind_name(side->kind)))
        return fail_hidden(piece, rt_ray_kind_name(side->kind), error);
    for (uint32_t p = 0; p < side->place_count; p++) {
        const RtClaimPlace *place = &side->places[p];
        if (!names(piece, place->key.key) && !names(piece, place->value))
            return fail_hidden(piece, place->key.key, error);
    }
    return RT_OK;
}

static RtStatus check_words(const RtFindingPiece *piece, const RtClaim *claim, RtError *error) {
    const char *word, *in = piece->words;
    size_t length;
    bool general = false;
    while (next_word(&in, piece->words + piece->length, &word, &length)) {
        char text[RT_MAX_WORD];
        double number;
        snprintf(text, sizeof text, "%.*s", (int)length, word);
        general |= is_general(word, length);
        if (is_number(word, length) && !(rt_swept_number(text, &number) && number == claim->number))
            return rt_fail(error, RT_BAD_INPUT, "'%s' is not the number of the claim '%s'", text,
                           piece->expression);
    }
    if (!general) return RT_OK;
    RT_TRY(check_places(piece, &claim->first, error));
    return claim->apart ? check_places(piece, &claim->second, error) : RT_OK;
}

RtStatus rt_finding_check_piece(const RtExperiment *experiment, const RtFindingPiece *piece, RtError *error) {
    RtClaim claim;
    if (piece->sort < RT_FINDING_READOUT) return RT_OK;
    RT_TRY(rt_claim_parse(experiment, piece->expression, &claim, error));
    if (claim.readout && piece->sort == RT_FINDING_CLAIM)
        return rt_fail(error, RT_BAD_INPUT, "'%s' is a figure, which has no words: write {%s}",
                       piece->expression, piece->expression);
    if (!claim.readout && piece->sort == RT_FINDING_READOUT)
        return rt_fail(error, RT_BAD_INPUT, "'%s' is a claim: write {WORDS: %s}", piece->expression,
                       piece->expression);
    return piece->sort == RT_FINDING_CLAIM ? check_words(piece, &claim, error) : RT_OK;
}

RtStatus rt_finding_check(const RtExperiment *experiment, const char *text, RtError *error) {
    RtFindingPiece piece;
    RtError why = {RT_OK, ""};
    for (const char *at = text; rt_finding_next(&at, &piece, &why);) {
        if (!*piece.from) RT_TRY(rt_finding_check_piece(experiment, &piece, error));
    }
    return why.status == RT_OK ? RT_OK : rt_fail(error, why.status, "%s", why.message);
}
