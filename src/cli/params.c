/* Parameter tables for people and for programs. */
#include "cli/cli.h"

#include <stdio.h>

void rt_cli_print_params(const RtParam *table, size_t count) {
    for (size_t i = 0; i < count; i++) {
        char range[RT_MAX_SPEC_CHARS];
        rt_param_range(&table[i], range, sizeof range);
        printf("  %-12s %s\n  %-12s   default %s (%s); %s\n", table[i].name, table[i].meaning, "",
               table[i].standard, table[i].source, range);
    }
}

json_t *rt_cli_params_json(const RtParam *table, size_t count) {
    json_t *params = json_array();
    for (size_t i = 0; i < count; i++) {
        char range[RT_MAX_SPEC_CHARS];
        rt_param_range(&table[i], range, sizeof range);
        json_array_append_new(params, json_pack("{s:s, s:s, s:s, s:s, s:s}", "name", table[i].name, "default",
                                                table[i].standard, "range", range, "meaning",
                                                table[i].meaning, "source", table[i].source));
    }
    return params;
}
