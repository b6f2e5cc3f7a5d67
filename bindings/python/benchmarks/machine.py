"""The machine on which a figure was measured."""
import os
import platform


def machine():
    """One line: processor, how many, kernel, load, Python, NumPy."""
    import numpy

    name = "?"
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        for line in file:
            if line.startswith("model name"):
                name = line.split(":", 1)[1].strip()
                break
    return (f"{os.cpu_count()} x {name}, Linux {platform.release()}, load {os.getloadavg()[0]:.1f}, "
            f"Python {platform.python_version()}, NumPy {numpy.__version__}")
