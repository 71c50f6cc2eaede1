// The world in 3D: models, and the data of sensors.

import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import type { LinkState } from "./frame";
import { Resolution } from "./resolution";
import { IS_SOFTWARE } from "./software";

/** Initial position of the camera relative to its target, in metres; and its height for the view from above. */
const HOME: [number, number, number] = [-2.2, -1.2, 1.4];
const ABOVE = 8;
/** Least angle of the camera above the floor, and its least distance in metres. */
const LEAST_ANGLE = 0.03;
const NEAREST = 0.1;
/** Largest distance of the camera in metres, or as a multiple of the extent of the world. */
const FARTHEST = 20;
const FARTHEST_SHARE = 1.5;

/** A frame that takes at most this time, in milliseconds, was drawn by a graphics card. */
const FAST_MS = 34;

/** Returns the same material with Lambert's law only, which takes a fraction of the time. */
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
  /** Least height of the world, in metres. */
  private floor = 0;
  private changed = true;
  private isDrawn = false;
  private axesShown = false;
  followsRobot = true;
  /** Height of the models, in metres. */
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
      // Shifting the camera also shifts its target, which must not go below the floor.
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

  /** Starts drawing, if it has not started. */
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
        // Waits for the previous frame, so that nothing queues up.
        if (gl.getSyncParameter(drawn.fence, gl.SYNC_STATUS) !== gl.SIGNALED) return;
        gl.deleteSync(drawn.fence);
        // Without a graphics card, drawing takes processor time; half of it is left for everything else.
        next = now + Math.max(0, now - drawn.began - FAST_MS);
        resolution?.tell(now - drawn.began);
        drawn = null;
      }
      if (now < next) return;
      // An unchanged view is not drawn again.
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
    // Without a layout there is nothing to draw on.
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setSize(clientWidth, clientHeight);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    this.touch();
  }

  /** Requests a redraw. */
  touch() {
    this.changed = true;
  }

  /** Shows only what is below this height. */
  cut(height: number) {
    this.ceiling.constant = height;
    this.touch();
  }

  showAxes(visible: boolean) {
    this.axesShown = visible;
    for (const axes of this.axes) axes.visible = visible;
    this.touch();
  }

  /** Replaces the models by those of a binary glTF file, unless another one was requested meanwhile. */
  async load(glb: ArrayBuffer, isWanted: () => boolean) {
    const { scene } = await new GLTFLoader().parseAsync(glb, "");
    if (!isWanted()) return;
    this.clear();
    const world = scene.getObjectByName("world") ?? scene;
    // In the file y is up; here z is up.
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

  /** Restores the initial view: the robot from behind. */
  home() {
    this.aim();
    this.look(HOME);
  }

  /** Shows the view from above, with the world's x axis up. */
  top() {
    this.aim();
    // Not exactly from the zenith, where the up direction of the camera is undefined.
    this.look([-1e-3, 0, ABOVE]);
  }

  /** Centres the robot, or the middle of the world. */
  private aim() {
    const [x, y, z] = this.robotPosition() ?? [0, 0, 0];
    this.controls.target.set(x, y, z + 0.2);
  }

  /** Returns the position of the camera. */
  get eye(): [number, number, number] {
    return this.camera.position.toArray();
  }

  /** Looks at the robot from a position relative to it. */
  look(from: [number, number, number]) {
    this.camera.position.set(...from).add(this.controls.target);
    this.controls.update();
  }

  /** Returns the distances between the points of a scan and the models that its rays hit, in metres; for tests. */
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

  /** Returns the ray from the eye through a position in the view, from -1 to 1. */
  ray(at: THREE.Vector2): THREE.Ray {
    const caster = new THREE.Raycaster();
    // The camera may have moved since the last frame.
    this.camera.updateMatrixWorld();
    caster.setFromCamera(at, this.camera);
    return caster.ray;
  }

  /** Returns the model at a position in the view, and the point that is hit. */
  pick(at: THREE.Vector2): { model: string; at: THREE.Vector3 } | null {
    const caster = new THREE.Raycaster();
    // The camera may have moved since the last frame.
    this.camera.updateMatrixWorld();
    caster.setFromCamera(at, this.camera);
    const met = caster.intersectObjects([...this.links.values()]).find(({ point }) => point.z < this.ceiling.constant);
    let object: THREE.Object3D | null = met?.object ?? null;
    while (object !== null && typeof object.userData.link !== "string") object = object.parent;
    if (met === undefined || object === null) return null;
    return { model: (object.userData.link as string).split("::")[0] ?? "", at: met.point };
  }

  /** Returns the position of a point of the world on the page. */
  pixelOf(point: [number, number, number]): [number, number] {
    this.camera.updateMatrixWorld();
    const seen = new THREE.Vector3(...point).project(this.camera);
    const box = this.renderer.domElement.getBoundingClientRect();
    return [box.left + ((seen.x + 1) / 2) * box.width, box.top + ((1 - seen.y) / 2) * box.height];
  }

  /** Converts a position on the page to one in the view, from -1 to 1. */
  placeOf([x, y]: [number, number]): THREE.Vector2 {
    const box = this.renderer.domElement.getBoundingClientRect();
    return new THREE.Vector2(2 * ((x - box.left) / box.width) - 1, 1 - 2 * ((y - box.top) / box.height));
  }

  get canvas(): HTMLCanvasElement {
    return this.renderer.domElement;
  }

  /** Moves links to their current poses. */
  move(states: LinkState[]) {
    const [at, turned] = [new THREE.Vector3(), new THREE.Quaternion()];
    for (const { name, position, orientation } of states) {
      const link = this.links.get(name);
      at.set(...position);
      turned.set(...orientation);
      // While time is paused, links do not move.
      if (link === undefined || (link.position.equals(at) && link.quaternion.equals(turned))) continue;
      link.position.copy(at);
      link.quaternion.copy(turned);
      this.touch();
    }
    if (this.followsRobot) this.lookAtRobot();
    else if (this.robot !== undefined) this.robotWas.copy(this.robot.position);
  }

  /** Returns the number of times that the view was drawn. */
  get drawn(): number {
    return this.renderer.info.render.frame;
  }

  /** Returns the pose of a link. */
  linkPosition(name: string): [number, number, number] | null {
    return this.links.get(name)?.position.toArray() ?? null;
  }

  /** Returns the position of the robot. */
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
