// The muscle in three dimensions, turned by mouse, touch and keys.

import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, CylinderGeometry, DirectionalLight, DoubleSide, Group,
  InstancedMesh, Matrix4, Mesh, MeshLambertMaterial, PerspectiveCamera, Scene, WebGLRenderer,
} from "three";
import { chamber, drums, fibre } from "./geometry.js";
import { colour, onTheme } from "./theme.js";

// How finely it is drawn, at most `budget` points of all fibres together: at rest, and while it moves where a
// processor has to draw.
const FINE = { samples: 600, sides: 6, around: 64, budget: 120_000, pixels: 2 };
const COARSE = { samples: 60, sides: 3, around: 32, budget: 9_000, pixels: 0.75 };
const PER_WAVE = 4; // points along a fibre from over to over
const CHORD = 0.2; // angle from point to point at most [rad], lest fibres cut into the chamber
const REST = 350;
const STEP = Math.PI / 36;

// Whether there is no graphics processor: then every pixel costs time.
function isSlow(renderer) {
  const gl = renderer.getContext();
  const about = gl.getExtension("WEBGL_debug_renderer_info");
  return /swiftshader|llvmpipe|software|basic render/i.test(String(about && gl.getParameter(about.UNMASKED_RENDERER_WEBGL)));
}

function buffer(parts) {
  const made = new BufferGeometry();
  for (const name of ["position", "normal"]) made.setAttribute(name, new BufferAttribute(parts[name], 3));
  if (parts.colour) made.setAttribute("color", new BufferAttribute(parts.colour, 3));
  made.setIndex(parts.index);
  return made;
}

export class Shape3D {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: false, alpha: false, powerPreference: "low-power" });
    this.slow = isSlow(this.renderer);
    this.detail = null;
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(24, 2, 0.01, 100);
    this.turned = new Group();
    this.body = new Group();
    this.turned.add(this.body);
    this.lamp = new DirectionalLight(0xffffff, 2.2);
    this.lamp.position.set(-1, 2, 3);
    this.scene.add(new AmbientLight(0xffffff, 1.1), this.lamp, this.turned);
    this.materials = {
      fibre: new MeshLambertMaterial({ vertexColors: true }),
      chamber: new MeshLambertMaterial({ side: DoubleSide }),
      drum: new MeshLambertMaterial(),
    };
    this.home();
    this.paint();
    onTheme(() => this.paint());
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.listen();
  }

  paint() {
    this.renderer.setClearColor(new Color(colour("back")));
    this.materials.chamber.color = new Color(colour("chamber"));
    this.materials.drum.color = new Color(colour("drum"));
    this.draw();
  }

  home() {
    Object.assign(this, { yaw: -0.35, pitch: 0.3, zoom: 1 });
    this.moved();
  }

  // A new shape; `wide` and `high` [m] are what the view must hold.
  show(shape, tint, wide, high) {
    Object.assign(this, { shape, tint, high: high / wide });
    this.body.scale.setScalar(1 / wide);
    this.body.rotation.y = Math.PI / 2; // its axis lies across the picture
    this.body.position.x = (-0.5 / wide) * (shape.z[0] + shape.z.at(-1));
    this.detail = null;
    this.moved();
  }

  // Drawn coarsely while it moves where that takes long, finely once it rests.
  moved() {
    clearTimeout(this.timer);
    this.refine(this.slow ? COARSE : FINE);
    if (this.slow) this.timer = setTimeout(() => this.refine(FINE), REST);
  }

  refine(detail) {
    if (!this.shape) return;
    if (detail !== this.detail) this.build(detail);
    this.detail = detail;
    this.draw();
  }

  build(detail) {
    const { shape } = this;
    for (const child of [...this.body.children]) {
      this.body.remove(child);
      child.geometry.dispose();
      child.dispose?.();
    }
    this.renderer.setPixelRatio(detail.pixels);
    this.resize();
    const count = Math.max(1, shape.fibres / 2);
    const round = shape.turn.at(-1) - shape.turn[0];
    const share = detail.budget / (2 * count);
    const woven = Math.ceil((PER_WAVE * round * count) / (2 * Math.PI)) + 1; // points for over and under to be seen
    const sides = share > woven * detail.sides ? detail.sides : 3;
    const weave = woven <= Math.min(detail.samples, share / sides);
    const samples = Math.max(weave ? woven : 0, Math.ceil(round / CHORD) + 1, 25);
    for (const hand of [1, -1]) {
      const mesh = new InstancedMesh(buffer(fibre(shape, hand, samples, sides, weave, this.tint)), this.materials.fibre, count);
      for (let k = 0; k < count; k++) mesh.setMatrixAt(k, new Matrix4().makeRotationZ((2 * Math.PI * k) / count));
      mesh.frustumCulled = false;
      this.body.add(mesh);
    }
    if (shape.wall) this.body.add(new Mesh(buffer(chamber(shape, detail.around)), this.materials.chamber));
    for (const { radius, long, middle } of drums(shape)) {
      const drum = new Mesh(new CylinderGeometry(radius, radius, long, detail.around), this.materials.drum);
      drum.rotation.x = Math.PI / 2;
      drum.position.z = middle;
      this.body.add(drum);
    }
  }

  draw() {
    if (this.frame || !this.shape) return;
    this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      this.turned.rotation.set(this.pitch, this.yaw, 0);
      const half = Math.tan((this.camera.fov * Math.PI) / 360);
      const far = Math.max(0.5 / (half * this.camera.aspect), (0.5 * this.high) / half) * 1.18 + 0.1;
      this.camera.position.set(0, 0, far / this.zoom);
      this.camera.updateProjectionMatrix();
      this.renderer.render(this.scene, this.camera);
    });
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    if (!clientWidth || !clientHeight) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.draw();
  }

  turn(yaw, pitch) {
    this.yaw += yaw;
    this.pitch = Math.min(Math.max(this.pitch + pitch, -1.5), 1.5);
    this.moved();
  }

  nearer(times) {
    this.zoom = Math.min(Math.max(this.zoom * times, 0.5), 6);
    this.moved();
  }

  listen() {
    const { canvas } = this;
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      if (canvas.hasPointerCapture(event.pointerId)) this.turn(0.008 * event.movementX, 0.008 * event.movementY);
    });
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && document.activeElement !== canvas) return; // the page scrolls, unless the shape is chosen
      event.preventDefault();
      this.nearer(event.deltaY < 0 ? 1.1 : 1 / 1.1);
    }, { passive: false });
    const keys = {
      ArrowLeft: () => this.turn(-STEP, 0), ArrowRight: () => this.turn(STEP, 0), ArrowUp: () => this.turn(0, -STEP),
      ArrowDown: () => this.turn(0, STEP), "+": () => this.nearer(1.15), "=": () => this.nearer(1.15),
      "-": () => this.nearer(1 / 1.15), Home: () => this.home(),
    };
    canvas.addEventListener("keydown", (event) => {
      if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      keys[event.key]();
    });
  }
}
