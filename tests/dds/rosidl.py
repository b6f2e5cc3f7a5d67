#!/usr/bin/python3
"""The messages of knurl-dds are those that rosidl's own adapter makes of .msg files: of Debian's (geometry_msgs, std_msgs, ...), and
of our package knurl_msgs.

    rosidl.py IDL-FOLDER MADE-FOLDER      runtime/dds/idl, and where knurl_msgs.idl and knurl_msgs/msg were made

Debian's .msg files are of ROS 1; where ROS 2 changed a definition they are changed first, and that is all: std_msgs/Header has
lost `seq`, `time` is builtin_interfaces/Time, `Header` is std_msgs/Header. Ends with 77 where the adapter is not installed.
"""

import importlib
import re
import sys
import tempfile
from pathlib import Path

SKIPPED = 77
OF_DEBIAN = {
    "std_msgs": ["Header", "Empty"],
    "geometry_msgs": ["Vector3", "Point", "Quaternion", "Pose", "PoseStamped", "Twist", "TwistStamped", "Wrench", "WrenchStamped",
                      "Transform", "TransformStamped"],
    "tf2_msgs": ["TFMessage"],
    "sensor_msgs": ["JointState", "Joy"],
    "diagnostic_msgs": ["KeyValue", "DiagnosticStatus", "DiagnosticArray"],
}
SAME = {"int32": "long", "uint32": "unsigned long", "uint8": "octet", "int64": "long long", "uint64": "unsigned long long"}


def typedefs(text):
    return dict((name, f"{kind}[{size}]") for kind, name, size in re.findall(r"typedef\s+([\w:]+)\s+(\w+)\[(\d+)\];", text))


def structs(text):
    """{"pkg::msg::Name": [(type, name)]} of an IDL file, in one spelling."""
    text = re.sub(r"//[^\n]*|#[^\n]*", "", text)
    text = re.sub(r"@verbatim\s*\((?:[^()\"]|\"(?:\\.|[^\"\\])*\")*\)", "", text)
    text = re.sub(r"@\w+(\s*\((?:[^()\"]|\"(?:\\.|[^\"\\])*\")*\))?", "", text)
    found, path = {}, []
    for token in re.finditer(r"module\s+(\w+)\s*\{|struct\s+(\w+)\s*\{([^}]*)\}\s*;|\}\s*;", text):
        if token.group(1):
            path.append(token.group(1))
        elif token.group(2):
            members = []
            for member in filter(None, (m.strip() for m in token.group(3).split(";"))):
                kind, name = re.fullmatch(r"(.+?)\s+(\w+)", " ".join(member.split())).groups()
                kind = kind.replace("dds_::", "")
                kind = re.sub(r"::(\w+)_\b", r"::\1", kind)
                kind = re.sub(r"\b(u?int(?:8|32|64))\b", lambda m: SAME[m.group(1)], kind)
                members.append((kind.replace(" ", ""), name.lstrip("_")))
            name = "::".join([part for part in path if part != "dds_"] + [token.group(2).rstrip("_")])
            found[name] = members
        elif path and not path[-1].endswith("_Constants"):
            path.pop()
        elif path:
            path.pop()
    return found


def ros2_text(text):
    text = re.sub(r"^uint32 seq\b.*$", "", text, flags=re.M)
    text = re.sub(r"^time ", "builtin_interfaces/Time ", text, flags=re.M)
    return re.sub(r"^Header ", "std_msgs/Header ", text, flags=re.M)


def adapted(package, source, folder):
    """What the adapter makes of a .msg file."""
    from rosidl_adapter.msg import convert_msg_to_idl
    inside = folder / package
    (inside / "msg").mkdir(parents=True, exist_ok=True)
    (inside / "msg" / source.name).write_text(ros2_text(source.read_text()))
    made = convert_msg_to_idl(inside, package, Path("msg") / source.name, folder / "idl" / package)
    return structs(Path(made).read_text())


def main():
    idl, made = map(Path, sys.argv[1:])
    try:
        importlib.import_module("rosidl_adapter.msg")
    except ImportError:
        print("rosidl: skipped: python3-rosidl and python3-empy are not installed")
        sys.exit(SKIPPED)
    missing = [package for package in OF_DEBIAN if not Path(f"/usr/share/{package}/msg").is_dir()]
    if missing:
        print(f"rosidl: skipped: these definitions are not installed: {', '.join(missing)}")
        sys.exit(SKIPPED)
    ours = structs((idl / "ros_messages.idl").read_text()) | structs((made / "knurl_msgs.idl").read_text())
    wrong, compared = [], 0
    with tempfile.TemporaryDirectory(prefix="knurl-rosidl-") as folder:
        sources = [(package, Path(f"/usr/share/{package}/msg/{name}.msg")) for package, names in OF_DEBIAN.items() for name in names]
        sources += [("knurl_msgs", path) for path in sorted((made / "knurl_msgs" / "msg").glob("*.msg"))]
        for package, source in sources:
            for name, members in adapted(package, source, Path(folder)).items():
                if name.endswith("_Constants"):
                    continue
                compared += 1
                mine = ours.get(name)
                if mine != members:
                    wrong.append(f"{name}: ours is {mine}, rosidl's {members}")
    for line in wrong:
        print(f"rosidl: {line}", file=sys.stderr)
    print(f"rosidl: {compared} messages compared with what rosidl's adapter makes")
    sys.exit(1 if wrong or compared < 20 else 0)


if __name__ == "__main__":
    main()
