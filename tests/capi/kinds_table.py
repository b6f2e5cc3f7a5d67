#!/usr/bin/python3
"""kinds_table.py knurl_kinds.h OUT.c: a C11 source that uses each wrapper of the header once, and has a table of its structs as the
compiler lays them out (kinds_table.h), read from the header's text and not from the tables that wrote it."""
import re
import sys

header, out = sys.argv[1:]
text = re.sub(r"///.*", "", open(header, encoding="utf-8").read())
structs = re.findall(r"typedef struct (knurl_\w+) \{(.*?)\} \1;", text, re.S)
wrappers = {name: body for name, body in re.findall(r"static inline \w+ (knurl_\w+)\((.*?)\) \{", text, re.S)}
used = set()


def use(name):
    used.add(name)
    return name


lines = ['#include "kinds_table.h"', "", "#include <stddef.h>", ""]
for struct, body in structs:
    kind = struct.removeprefix("knurl_")
    members = re.findall(r"(\w+) (\w+)(?:\[(\d+)\])?;", body)
    assert members[0][:2] == ("uint64_t", "size"), f"{struct} does not begin with its size"
    lines += [f'_Static_assert(offsetof({struct}, size) == 0, "size first");',
              f'_Static_assert(sizeof({struct}) % 8 == 0, "no bytes behind the last member\'s alignment");']
    before = members[0][1]
    for _, member, _ in members[1:]:
        lines.append(f'_Static_assert(offsetof({struct}, {member}) >= offsetof({struct}, {before}) + '
                     f'sizeof((({struct}*)0)->{before}), "{member} overlaps");')
        before = member
    lines.append(f"static const struct member {kind}_members[] = {{")
    lines += [f'    {{"{member}", offsetof({struct}, {member}), sizeof((({struct}*)0)->{member})}},' for _, member, _ in members[1:]]
    lines += ["};",
              f"static int use_{kind}(knurl_hand* hand, knurl_id* id) {{",
              f"    {struct} params;",
              f"    {use('knurl_default_' + kind)}(&params);",
              f"    int code = {use('knurl_add_' + kind)}(hand, &params, NULL, id);",
              f"    if (code == KNURL_OK) code = {use('knurl_set_' + kind)}(hand, *id, &params);",
              f"    if (code == KNURL_OK) code = {use('knurl_get_' + kind)}(hand, *id, &params);",
              "    return code;",
              "}", ""]
lines.append("const struct kind_row kind_rows[] = {")
for struct, _ in structs:
    kind = struct.removeprefix("knurl_")
    lines.append(f'    {{"{kind}", KNURL_{kind.upper()}, sizeof({struct}), {kind}_members, '
                 f"sizeof {kind}_members / sizeof *{kind}_members, use_{kind}}},")
lines += ["};", "const size_t kind_row_count = sizeof kind_rows / sizeof *kind_rows;", ""]
lines.append("const struct choice_row choice_rows[] = {")
for struct, member, values in re.findall(r"(knurl_\w+)::(\w+): [^\n]*\nenum \{(.*?)\};",
                                         open(header, encoding="utf-8").read(), re.S):
    kind = struct.removeprefix("knurl_")
    prefix = f"KNURL_{kind.upper()}_{member.upper()}_"
    for constant in re.findall(r"(KNURL_\w+) =", values):
        lines.append(f'    {{"{kind}", "{member}", "{constant.removeprefix(prefix)}", {constant}}},')
lines += ["};", "const size_t choice_row_count = sizeof choice_rows / sizeof *choice_rows;"]
missing = set(wrappers) - used
assert not missing, f"wrappers that no line here uses: {sorted(missing)}"
with open(out, "w", encoding="utf-8") as file:
    file.write("\n".join(lines) + "\n")
