// The files of the page, all in memory: its own, the viewer of `latvox view`, and three.js' loaders.
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';

const VIEWER = ['three', 'voxels', 'cells', 'facets', 'surface', 'data', 'flat', 'view', 'controls'];
const LOADERS = ['STLLoader', 'OBJLoader', 'PLYLoader', 'GLTFLoader'];
const OWN = [
  'address.js',
  'app.js',
  'bricks.js',
  'cell.js',
  'colors.js',
  'fields.js',
  'job.js',
  'live.js',
  'meshes.js',
  'npz.js',
  'ply.js',
  'receive.js',
  'request.js',
  'scene.js',
  'service.js',
  'save.js',
  'settings.js',
];
const TYPES = { html: 'text/html; charset=utf-8', js: 'text/javascript; charset=utf-8' };

const read = (path) => readFileSync(new URL(path, import.meta.url));

// Returns the viewer's page with its scripts as files. Its data come from the page around it: see page/receive.js.
function viewer() {
  const script = (path) => `<script src="${path}"></script>`,
    before = script('receive.js'),
    after = script('live.js');
  let html = String(read('../../client/tool/view/page.html'));
  for (const name of ['data', 'bricks', 'colors', 'values']) html = html.replace(`{{${name}}}`, '');
  return html
    .replace(/<script>\n\{\{(\w+)\}\}\n<\/script>/g, (_, name) => {
      const file = script(`viewer/${name.replace('_js', '')}.js`);
      return name === 'data_js' ? `${before}${file}${after}` : file;
    })
    .replace('</style>', '</style><link rel="stylesheet" href="viewer.css">');
}

export class Pages {
  constructor() {
    const index = read('page/index.html');
    this.files = new Map([
      ['/', index],
      ['/viewer.html', Buffer.from(viewer())],
      ['/viewer.css', read('page/viewer.css')],
      ['/page.css', read('page/page.css')],
    ]);
    for (const name of OWN) this.files.set(`/${name}`, read(`page/${name}`));
    for (const name of VIEWER) this.files.set(`/viewer/${name}.js`, read(`../../client/tool/view/${name}.js`));
    for (const name of LOADERS) this.files.set(`/three/loaders/${name}.js`, this.addon(`loaders/${name}.js`));
    this.files.set('/three/utils/BufferGeometryUtils.js', this.addon('utils/BufferGeometryUtils.js'));
    this.files.set('/fflate.js', read('node_modules/fflate/esm/browser.js'));
    for (const name of ['three.module.min.js', 'three.core.min.js'])
      this.files.set(`/three/${name}`, read(`node_modules/three/build/${name}`));
    // The only script within the page is its map of imports.
    const [, map] = String(index).match(/<script type="importmap">([^]*?)<\/script>/);
    const hash = createHash('sha256').update(map).digest('base64');
    this.policy =
      `default-src 'none'; script-src 'self' 'sha256-${hash}'; style-src 'self' 'unsafe-inline'; ` +
      "connect-src 'self' blob: data:; " +
      "img-src 'self' blob: data:; frame-src 'self'; frame-ancestors 'self'; base-uri 'none'; form-action 'none'";
  }

  addon(path) {
    return read(`node_modules/three/examples/jsm/${path}`);
  }

  // Returns whether there is such a file.
  serve(path, request, response) {
    const file = this.files.get(path);
    if (file === undefined) return false;
    const type = path.endsWith('.css') ? 'text/css; charset=utf-8' : TYPES[path.endsWith('.js') ? 'js' : 'html'];
    const tag = `"${createHash('sha256').update(file).digest('base64url').slice(0, 22)}"`;
    const headers = {
      'content-type': type,
      'cache-control': 'no-cache',
      etag: tag,
      'content-security-policy': this.policy,
      'referrer-policy': 'no-referrer',
    };
    if (request.headers['if-none-match'] === tag) response.writeHead(304, headers).end();
    else
      response
        .writeHead(200, { ...headers, 'content-length': file.length })
        .end(request.method === 'HEAD' ? undefined : file);
    return true;
  }
}
