// The world in 3D: models, and what sensors measure of it.

import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import type { LinkState } from "./frame";
import { Resolution } from "./resolution";
import { IS_SOFTWARE } from "./software";

/** Where the camera is at first, from what it looks at, metres; and how high it is for the view from above. */
const HOME: [number, number, number] = [-2.2, -1.2, 1.4];
const ABOVE = 8;
/** The camera stays above the floor, by this angle, and comes no nearer than this, metres. */
const LEAST_ANGLE = 0.03;
const NEAREST = 0.1;
/** It goes as far away as this, metres, or so many times as far as the world reaches. */
const FARTHEST = 20;
const FARTHEST_SHARE = 1.5;

/** A frame that is drawn in so much time, milliseconds, is drawn by a graphics card. */
const FAST_MS = 34;

/** The same material by Lambert's law alone, which takes a fraction of the time of a physical one. */
function cheap({ name, color, map, side, transparent, opacity, vertexColors }: THREE.MeshStandardMaterial) {
  return new THREE.MeshLambertMaterial({ name, color, map, side, transparent, opacity, vertexColors });
}

export class Space {
  readonly scene = new THREE.Scene();
  private readonly renderer: THREE.WebGLRenderer;
  private readonly camera = new THREE.PerspectiveCamera(55, 1, 0.02, 500);
  private readonly controls: OrbitControls;
  private readonly links = new Map<string, THREE.Object3D>();
  private readonly axes: THREE.AxesHelper[] = [];
  private readonly ceiling = new THREE.Plane(new THREE.Vector3(0, 0, -1), 100);
  private world: THREE.Object3D | undefined;
  private robot: THREE.Object3D | undefined;
  private readonly robotWas = new THREE.Vector3();
  /** Where the world is lowest. */
  private floor = 0;
  private changed = true;
  private isDrawn = false;
  private axesShown = false;
  followsRobot = true;
  /** Height of what there is, metres. */
  height = 3;

  constructor(private readonly place: HTMLElement) {
    this.renderer = new THREE.WebGLRenderer({ antialias: !IS_SOFTWARE });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.localClippingEnabled = true;
    place.append(this.renderer.domElement);
    this.scene.background = new THREE.Color(0x12171e);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x9a9a9a, 2.2));
    const sun = new THREE.DirectionalLight(0xffffff, 1.2);
    sun.position.set(2, -3, 6);
    this.scene.add(sun);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.maxPolarAngle = Math.PI / 2 - LEAST_ANGLE;
    this.controls.minDistance = NEAREST;
    this.controls.maxDistance = FARTHEST;
    this.controls.addEventListener("change", () => {
      // What is shifted takes along what it looks at, which must not go under the floor either.
      const below = this.floor - this.controls.target.z;
      if (below > 0) {
        this.controls.target.z += below;
        this.camera.position.z += below;
      }
      this.touch();
    });
    this.home();
    new ResizeObserver(() => {
      this.resize();
    }).observe(place);
    this.resize();
  }

  /** Begins to draw, if it has not. */
  start() {
    if (this.isDrawn) return;
    this.isDrawn = true;
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    let drawn: { fence: WebGLSync; began: number } | null = null;
    let next = 0;
    const resolution = IS_SOFTWARE ? new Resolution() : null;
    let share = 1;
    const draw = (now: number) => {
      requestAnimationFrame(draw);
      if (drawn !== null) {
        // What is still being drawn is waited for, so that nothing queues up.
        if (gl.getSyncParameter(drawn.fence, gl.SYNC_STATUS) !== gl.SIGNALED) return;
        gl.deleteSync(drawn.fence);
        // Without a graphics card drawing takes the processors' time: half of it is left to all else.
        next = now + Math.max(0, now - drawn.began - FAST_MS);
        resolution?.tell(now - drawn.began);
        drawn = null;
      }
      if (now < next) return;
      // What has not changed is not drawn again.
      const wanted = resolution === null ? (this.changed ? 1 : null) : resolution.next(now, this.changed);
      if (wanted === null) return;
      this.changed = false;
      if (wanted !== share) this.renderer.setPixelRatio(wanted * Math.min(window.devicePixelRatio, 2));
      share = wanted;
      this.renderer.render(this.scene, this.camera);
      const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
      gl.flush();
      if (fence !== null) drawn = { fence, began: now };
    };
    requestAnimationFrame(draw);
  }

  private resize() {
    const { clientWidth, clientHeight } = this.place;
    // Not laid out: there is nothing to draw on.
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setSize(clientWidth, clientHeight);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    this.touch();
  }

  /** Has it drawn again. */
  touch() {
    this.changed = true;
  }

  /** Shows what is below this height. */
  cut(height: number) {
    this.ceiling.constant = height;
    this.touch();
  }

  showAxes(visible: boolean) {
    this.axesShown = visible;
    for (const axes of this.axes) axes.visible = visible;
    this.touch();
  }

  /** Shows the models of a binary glTF file instead of those before, if it is still wanted once it is read. */
  async load(glb: ArrayBuffer, isWanted: () => boolean) {
    const { scene } = await new GLTFLoader().parseAsync(glb, "");
    if (!isWanted()) return;
    this.clear();
    const world = scene.getObjectByName("world") ?? scene;
    // The file turns z up into y up; here z is up.
    world.quaternion.identity();
    world.traverse((object) => {
      const link: unknown = object.userData.link;
      if (typeof link === "string") {
        this.links.set(link, object);
        if (object.userData.robot === true) this.robot ??= object;
      }
      if (object instanceof THREE.Mesh) {
        if (IS_SOFTWARE) object.material = cheap(object.material as THREE.MeshStandardMaterial);
        for (const material of [object.material].flat() as THREE.Material[]) {
          material.clippingPlanes = [this.ceiling];
        }
      }
    });
    this.scene.add(world);
    this.world = world;
    for (const link of this.links.values()) {
      if (link.userData.robot !== true) continue;
      const axes = new THREE.AxesHelper(0.1);
      axes.visible = this.axesShown;
      this.axes.push(axes);
      link.add(axes);
    }
    const box = new THREE.Box3().setFromObject(world);
    this.height = Math.max(0.5, box.max.z);
    this.floor = Math.min(0, box.min.z);
    const reach = box.getSize(new THREE.Vector3()).length() / 2;
    this.controls.maxDistance = Math.max(FARTHEST, FARTHEST_SHARE * reach);
    this.lookAtRobot();
    this.touch();
  }

  private clear() {
    this.world?.removeFromParent();
    this.world?.traverse((object) => {
      if (!(object instanceof THREE.Mesh)) return;
      (object.geometry as THREE.BufferGeometry).dispose();
      for (const material of [object.material].flat() as THREE.MeshStandardMaterial[]) {
        material.map?.dispose();
        material.dispose();
      }
    });
    this.links.clear();
    this.axes.length = 0;
    this.robot = undefined;
  }

  private lookAtRobot() {
    if (this.robot === undefined) return;
    const at = this.robot.position;
    this.camera.position.add(at).sub(this.robotWas);
    this.controls.target.add(at).sub(this.robotWas);
    this.robotWas.copy(at);
    this.controls.update();
  }

  /** Looks as at first: at the robot, from behind. */
  home() {
    this.aim();
    this.look(HOME);
  }

  /** Looks from above, with the world's x up. */
  top() {
    this.aim();
    // Not from the very zenith, where the camera would not know which way is up.
    this.look([-1e-3, 0, ABOVE]);
  }

  /** Has the robot, or the middle of the world, in the middle. */
  private aim() {
    const [x, y, z] = this.robotPosition() ?? [0, 0, 0];
    this.controls.target.set(x, y, z + 0.2);
  }

  /** Where the camera is. */
  get eye(): [number, number, number] {
    return this.camera.position.toArray();
  }

  /** Looks at the robot from a place beside it. */
  look(from: [number, number, number]) {
    this.camera.position.set(...from).add(this.controls.target);
    this.controls.update();
  }

  /** How far the points of a scan lie from where its rays meet the models, metres: what a test asks. */
  scanDistances(topic: string): number[] {
    const points = this.scene.getObjectByName(topic);
    if (!(points instanceof THREE.Points)) return [];
    this.scene.updateMatrixWorld();
    const geometry = points.geometry as THREE.BufferGeometry;
    const places = geometry.getAttribute("position") as THREE.BufferAttribute | undefined;
    const things = [...this.links.values()].filter((link) => link.userData.robot !== true);
    const [distances, caster, place] = [[] as number[], new THREE.Raycaster(), new THREE.Vector3()];
    for (let index = 0; places !== undefined && index < geometry.drawRange.count; index += 3) {
      place.fromBufferAttribute(places, index).applyMatrix4(points.matrixWorld).sub(points.position);
      const range = place.length();
      caster.set(points.position, place.normalize());
      const met = caster.intersectObjects(things)[0];
      if (met !== undefined) distances.push(Math.abs(met.distance - range));
    }
    return distances;
  }

  /** The ray from the eye through a place of the view, from -1 to 1. */
  ray(at: THREE.Vector2): THREE.Ray {
    const caster = new THREE.Raycaster();
    // It may have been moved since it was drawn.
    this.camera.updateMatrixWorld();
    caster.setFromCamera(at, this.camera);
    return caster.ray;
  }

  /** The model under a place of the view, and where it is met. */
  pick(at: THREE.Vector2): { model: string; at: THREE.Vector3 } | null {
    const caster = new THREE.Raycaster();
    // It may have been moved since it was drawn.
    this.camera.updateMatrixWorld();
    caster.setFromCamera(at, this.camera);
    const met = caster.intersectObjects([...this.links.values()]).find(({ point }) => point.z < this.ceiling.constant);
    let object: THREE.Object3D | null = met?.object ?? null;
    while (object !== null && typeof object.userData.link !== "string") object = object.parent;
    if (met === undefined || object === null) return null;
    return { model: (object.userData.link as string).split("::")[0] ?? "", at: met.point };
  }

  /** Where a point of the world is on the page. */
  pixelOf(point: [number, number, number]): [number, number] {
    this.camera.updateMatrixWorld();
    const seen = new THREE.Vector3(...point).project(this.camera);
    const box = this.renderer.domElement.getBoundingClientRect();
    return [box.left + ((seen.x + 1) / 2) * box.width, box.top + ((1 - seen.y) / 2) * box.height];
  }

  /** The other way: a place of the view, from -1 to 1. */
  placeOf([x, y]: [number, number]): THREE.Vector2 {
    const box = this.renderer.domElement.getBoundingClientRect();
    return new THREE.Vector2(2 * ((x - box.left) / box.width) - 1, 1 - 2 * ((y - box.top) / box.height));
  }

  get canvas(): HTMLCanvasElement {
    return this.renderer.domElement;
  }

  /** Puts links where they are now. */
  move(states: LinkState[]) {
    const [at, turned] = [new THREE.Vector3(), new THREE.Quaternion()];
    for (const { name, position, orientation } of states) {
      const link = this.links.get(name);
      at.set(...position);
      turned.set(...orientation);
      // While time stands they are where they were.
      if (link === undefined || (link.position.equals(at) && link.quaternion.equals(turned))) continue;
      link.position.copy(at);
      link.quaternion.copy(turned);
      this.touch();
    }
    if (this.followsRobot) this.lookAtRobot();
    else if (this.robot !== undefined) this.robotWas.copy(this.robot.position);
  }

  /** How often it has been drawn. */
  get drawn(): number {
    return this.renderer.info.render.frame;
  }

  /** Where a link is. */
  linkPosition(name: string): [number, number, number] | null {
    return this.links.get(name)?.position.toArray() ?? null;
  }

  /** Where the robot is. */
  robotPosition(): [number, number, number] | null {
    return this.robot?.position.toArray() ?? null;
  }

  add(object: THREE.Object3D) {
    this.scene.add(object);
    this.touch();
  }

  remove(object: THREE.Object3D) {
    object.removeFromParent();
    this.touch();
  }
}
