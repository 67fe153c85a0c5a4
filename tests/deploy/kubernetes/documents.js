// The manifests of deploy/kubernetes, as written and as kustomize renders them.
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import yaml from 'yaml';

export const ROOT = fileURLToPath(new URL('../../../deploy/kubernetes', import.meta.url));
export const OVERLAYS = ['service', 'batch', 'gateway'];

const parse = (text) => yaml.parseAllDocuments(text, { strict: true }).map((document) => {
  if (document.errors.length > 0) throw document.errors[0];
  return document.toJS();
});
export const lone = (file) => parse(readFileSync(path.join(ROOT, file), 'utf8'));
export const kustomization = (folder) => parse(readFileSync(path.join(ROOT, folder, 'kustomization.yaml'), 'utf8'))[0];

// Returns the objects of a folder and of the folders that it builds on: without a kustomization's changes to them, but
// with the objects that it generates.
export function written(folder) {
  const { resources, components = [], configMapGenerator = [] } = kustomization(folder);
  const objects = [...resources, ...components].flatMap((name) => {
    const file = path.join(folder, name);
    return name.endsWith('.yaml') ? parse(readFileSync(path.join(ROOT, file), 'utf8')) : written(file);
  });
  const configMaps = configMapGenerator.map(({ name, files }) => ({
    apiVersion: 'v1',
    kind: 'ConfigMap',
    metadata: { name },
    data: Object.fromEntries(files.map((file) => [file, readFileSync(path.join(ROOT, folder, file), 'utf8')])),
  }));
  return [...objects, ...configMaps];
}

function output(...command) {
  try {
    return execFileSync(command[0], command.slice(1), { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] });
  } catch {
    return '';  // not installed
  }
}

// Returns why kubectl is missing; false if it is there.
export const kubectlMissing = () => output('kubectl', 'version', '--client') === '' && 'kubectl is not installed';

// Returns a command that renders a folder, or why there is none. `replacements` need kustomize 5. Debian's kustomize, which
// is of version 5, calls its version `(devel)`.
export function findKustomize() {
  const versions = [
    [['kubectl', 'kustomize'], output('kubectl', 'version', '--client')],
    [['kustomize', 'build'], output('kustomize', 'version')],
  ];
  const [command] = versions.find(([, told]) => /^(Kustomize Version: )?(v([5-9]|\d{2,})\.|\(devel\)$)/m.test(told)) ?? [];
  return command ? { command } : { missing: 'neither kubectl nor kustomize is installed with kustomize 5' };
}

export function rendered(command, folder, root = ROOT) {
  const stdio = ['ignore', 'pipe', 'pipe'];
  return parse(execFileSync(command[0], [...command.slice(1), path.join(root, folder)], { encoding: 'utf8', stdio }));
}
