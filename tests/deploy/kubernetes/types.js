// Checks objects against the types of the Kubernetes API and of the Prometheus operator, by the TypeScript compiler:
// unknown fields, missing fields, and fields of another type.
import { fileURLToPath } from 'node:url';
import ts from 'typescript';

const FILE = fileURLToPath(new URL('manifests.ts', import.meta.url));  // in memory only
const OPTIONS = {
  strict: true, exactOptionalPropertyTypes: true, noEmit: true, skipLibCheck: true, types: [],
  target: ts.ScriptTarget.ES2022, module: ts.ModuleKind.NodeNext, moduleResolution: ts.ModuleResolutionKind.NodeNext,
};

// Returns the module of a kind, by the layout of the packages.
const moduleOf = ({ apiVersion, kind }) =>
  `${apiVersion.startsWith('monitoring.coreos.com/') ? '@kubernetes-models/prometheus-operator' : 'kubernetes-models'}/${apiVersion}/${kind}`;

const declaration = (object, n) =>
  `import type { I${object.kind} as Kind${n} } from ${JSON.stringify(moduleOf(object))};\n` +
  `export const object${n}: Kind${n} = ${JSON.stringify(object, null, 1)};\n`;

// Returns one line for people for each mistake.
export function typeErrors(objects) {
  const source = objects.map(declaration).join('');
  const host = ts.createCompilerHost(OPTIONS);
  const { getSourceFile, fileExists, readFile } = host;
  host.fileExists = (name) => name === FILE || fileExists(name);
  host.readFile = (name) => (name === FILE ? source : readFile(name));
  host.getSourceFile = (name, ...rest) =>
    name === FILE ? ts.createSourceFile(name, source, OPTIONS.target) : getSourceFile(name, ...rest);
  const program = ts.createProgram([FILE], OPTIONS, host);
  return ts.getPreEmitDiagnostics(program).map((diagnostic) => ts.flattenDiagnosticMessageText(diagnostic.messageText, ' '));
}
