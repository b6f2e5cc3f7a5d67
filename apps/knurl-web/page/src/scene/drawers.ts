// Which drawer draws which kind. A kind that is not here has a cross where its first place is.
import { Group } from "three";
import { type Drawing, type Paint, lines, vector } from "./drawing.ts";
import { constantForce, constraint, gravity, magnet, spring, taylor, vibration, viscosity } from "./effects.ts";
import { cap, halfPlane, plane, polygon } from "./planes.ts";
import { box, capsule, cylinder, shape, sphere, torus } from "./solids.ts";

const drawers: Record<string, (paint: Paint) => Drawing> = {
  plane, cap, polygon, half_plane: halfPlane, box, sphere, capsule, cylinder, torus, shape,
  spring, magnet, constraint, taylor, taylor6: taylor, constant_force: constantForce, gravity, viscosity, vibration,
};

function unknown(paint: Paint): Drawing {
  const root = new Group();
  root.add(lines([-1, 0, 0, 1, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, -1, 0, 0, 1], paint.line));
  return {
    root,
    update(params, around) {
      const place = Object.entries(params).find(([, value]) => Array.isArray(value) && value.length === 3);
      if (place) root.position.copy(vector(params, place[0]));
      root.scale.setScalar(0.1 * around.radius);
    },
  };
}

export function draw(kind: string, paint: Paint): Drawing {
  return (drawers[kind] ?? unknown)(paint);
}
