// The parts of three.js that view.js needs: `bundle` makes three.js from them.
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
