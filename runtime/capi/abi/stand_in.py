#!/usr/bin/python3
"""stand_in.py HEADER... : C++ that defines each function the headers declare, and a variable of each of their types.

The libraries themselves are built without debug information, and no function takes an enumeration or the struct of a kind by its
type. Compiled with -g, this has all of what a caller compiles against, whatever the build is. That the libraries export the same
functions is what tests/capi looks at.
"""

import re
import sys
from pathlib import Path

text = "\n".join(re.sub(r"//[^\n]*", "", Path(header).read_text(encoding="utf-8")) for header in sys.argv[1:])
print('#include <knurl.h>\n#include <knurl_offline.h>\nextern "C" {')
for returns, name, arguments in re.findall(r"^KNURL_API ([\w\s*]+?)\b(knurl_\w+)\(([^;]*)\);", text, re.M):
    print(f"{returns}{name}({arguments}) {{ return{'' if returns.strip() == 'void' else ' {}'}; }}")
for name in re.findall(r"^typedef (?:struct|enum) (\w+) \{", text, re.M):
    print(f"{name} of_{name};")
for first in re.findall(r"^enum \{\s*(\w+) =", text, re.M):
    print(f"decltype({first}) of_{first};")
print("}")
