// Faults of a device by the names of `knurl ls` (runtime/protocol/report.hpp), with docs/howto/troubleshooting.md's causes.

export interface Fault {
  name: string;
  cause: string;
  remedy: string;
}

const table: Fault[] = [
  { name: "not finite", cause: "A scene computed a value that is not a number.", remedy: "Report it: the servo should have refused the parameter." },
  { name: "slew", cause: "The force changed by more than 2000 N/s for 5 ms: an unstable loop.", remedy: "Lower the stiffness or add damping; see what buzzes. Then reset." },
  { name: "speed", cause: "The hand was faster than 1.5 m/s: the device was thrown, or the loop is unstable.", remedy: "Hold the device still; lower the stiffness if it ran away by itself. Then reset." },
  { name: "power", cause: "More than 5 W went into the hand over 50 ms: an unstable loop, often a coupling without an energy account.", remedy: "Use a coupling with an energy account, or less stiffness. Then reset." },
  { name: "unplugged", cause: "The device is gone.", remedy: "Check cable and power. It comes back by itself, then reset." },
  { name: "bad samples", cause: "Ten unusable samples came in a row.", remedy: "Check cable, hub, interference; run knurl device test. Then reset." },
  { name: "encoder jump", cause: "The position jumped by more than a hand can.", remedy: "Calibrate (home) the device; check its cable. Then reset." },
  { name: "clock jump", cause: "The machine was suspended, or the servo stopped for more than a second.", remedy: "Reset." },
  { name: "kinematics", cause: "The mechanism has no pose for the joints.", remedy: "Check the arm's file; home the device. Then reset." },
  { name: "guardian", cause: "The servo made no cycle for 20 ms with force on, and the guardian put the motors to zero.", remedy: "Look for late cycles: knurl doctor, knurl trace --around late. Then reset." },
  { name: "overload", cause: "Cycles took longer than the period for 20 ms: too many representations at the hand, or a busy machine without real-time rights.", remedy: "Remove representations, or run the servo at a lower rate. Then reset." },
  { name: "unguarded", cause: "The process knurl-guardian did not run for 40 ms (250 ms without real-time rights).", remedy: "Let it go on if somebody stopped it (kill -CONT); give it real-time rights. Then reset." },
];

/** In the order of their bits. */
export const faultNames = ["not finite", "slew", "speed", "power", "unplugged", "bad samples", "encoder jump", "clock jump", "kinematics", "guardian", "overload", "unguarded"];

export function faultOf(name: string): Fault {
  const plain = name.replaceAll("_", " ");
  return (
    table.find((fault) => fault.name === plain) ?? {
      name: plain,
      cause: "A fault that this page does not know.",
      remedy: "See docs/howto/troubleshooting.md of the servo's version.",
    }
  );
}

/** Of a bit mask. */
export function faultsOf(mask: number): string[] {
  return faultNames.filter((_, bit) => mask & (1 << bit));
}
