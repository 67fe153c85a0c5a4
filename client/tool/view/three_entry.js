// What view.js needs of three.js: `bundle` makes three.js of it.
export {
  BufferAttribute,
  BufferGeometry,
  Color,
  DataTexture,
  Group,
  Matrix3,
  Mesh,
  PerspectiveCamera,
  Points,
  RGBAFormat,
  RGBAIntegerFormat,
  Scene,
  ShaderMaterial,
  UnsignedByteType,
  UnsignedShortType,
  Vector3,
  Vector4,
  WebGLRenderer,
} from "three";
export { OrbitControls } from "three/addons/controls/OrbitControls.js";
