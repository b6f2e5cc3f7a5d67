// What stands still is drawn together: a hundred things are two calls of the graphics card in place of two hundred. The things
// themselves stay in the scene, for whoever looks for them, on a layer that the camera does not see.
import { BufferAttribute, BufferGeometry, DoubleSide, DynamicDrawUsage, Group, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshLambertMaterial, type Object3D, Vector3 } from "three";

/** The layer of what a batch draws; the camera sees layer 0. */
export const batchedLayer = 1;

interface Part {
  object: Mesh | LineSegments;
  /** First vertex and number of vertices in the batch. */
  start: number;
  count: number;
  colour: number;
  opacity: number;
}

class Kind {
  parts: Part[] = [];
  constructor(readonly into: Mesh | LineSegments) {
    into.frustumCulled = false;
    into.visible = false;
  }
  /** Copies the geometry of all parts, in the frame of `root`. */
  fill(objects: (Mesh | LineSegments)[], root: Object3D, faces: boolean): void {
    let vertices = 0;
    for (const object of objects) {
      const geometry = object.geometry as BufferGeometry;
      vertices += faces ? (geometry.index?.count ?? geometry.getAttribute("position").count) : geometry.getAttribute("position").count;
    }
    const position = new Float32Array(3 * vertices);
    const normal = faces ? new Float32Array(3 * vertices) : null;
    const colour = new BufferAttribute(new Float32Array(4 * vertices), 4);
    colour.setUsage(DynamicDrawUsage);
    const toRoot = root.matrixWorld.clone().invert();
    const matrix = new Matrix4();
    const v = new Vector3();
    let at = 0;
    this.parts = objects.map((object) => {
      const geometry = object.geometry as BufferGeometry;
      matrix.multiplyMatrices(toRoot, object.matrixWorld);
      const p = geometry.getAttribute("position");
      const n = geometry.getAttribute("normal");
      const index = faces ? geometry.index : null;
      const count = index?.count ?? p.count;
      for (let k = 0; k < count; k++) {
        const vertex = index ? index.getX(k) : k;
        v.fromBufferAttribute(p, vertex).applyMatrix4(matrix).toArray(position, 3 * (at + k));
        if (normal && n) v.fromBufferAttribute(n, vertex).transformDirection(matrix).toArray(normal, 3 * (at + k));
      }
      const part = { object, start: at, count, colour: -1, opacity: -1 };
      at += count;
      return part;
    });
    this.into.geometry.dispose();
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(position, 3));
    if (normal) geometry.setAttribute("normal", new BufferAttribute(normal, 3));
    geometry.setAttribute("color", colour);
    this.into.geometry = geometry;
    this.into.visible = vertices > 0;
  }
  /** Colours of what has changed its look. */
  colour(): void {
    const colour = this.into.geometry.getAttribute("color") as BufferAttribute | undefined;
    if (!colour) return;
    for (const part of this.parts) {
      const material = part.object.material as MeshLambertMaterial;
      const hex = material.color.getHex();
      if (hex === part.colour && material.opacity === part.opacity) continue;
      part.colour = hex;
      part.opacity = material.opacity;
      for (let k = part.start; k < part.start + part.count; k++) colour.setXYZW(k, material.color.r, material.color.g, material.color.b, material.opacity);
      colour.addUpdateRange(4 * part.start, 4 * part.count);
      colour.needsUpdate = true;
    }
  }
}

export class Batch {
  readonly root = new Group();
  private readonly faces = new Kind(new Mesh(new BufferGeometry(), new MeshLambertMaterial({ vertexColors: true, transparent: true, depthWrite: false, side: DoubleSide, forceSinglePass: true })));
  private readonly lines = new Kind(new LineSegments(new BufferGeometry(), new LineBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false })));
  private members: Object3D[] = [];
  constructor() {
    this.root.add(this.faces.into, this.lines.into);
  }

  /** Draws these and nothing else; what is no longer one of them draws itself again. */
  take(members: Object3D[], root: Object3D): void {
    for (const member of this.members) member.traverse((object) => object.layers.set(0));
    this.members = members;
    const faces: Mesh[] = [];
    const lines: LineSegments[] = [];
    root.updateWorldMatrix(true, true);
    for (const member of members)
      member.traverseVisible((object) => {
        if ((object as LineSegments).isLineSegments) lines.push(object as LineSegments);
        else if ((object as Mesh).isMesh) faces.push(object as Mesh);
        object.layers.set(batchedLayer);
      });
    this.faces.fill(faces, root, true);
    this.lines.fill(lines, root, false);
    this.colour();
  }
  colour(): void {
    this.faces.colour();
    this.lines.colour();
  }
}
