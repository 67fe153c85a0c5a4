// Checks the output of kustomize for deploy/kubernetes, and the Secrets of deploy/docs. Exits with 77,
// ctest's "skipped", without kustomize or kubectl.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { check, SECRETS, withFiles } from './check.js';
import { findKustomize, kubectlMissing, OVERLAYS, rendered, written } from './documents.js';

const { command, missing = kubectlMissing() } = findKustomize();
if (missing) {
  console.error(`SKIPPED: ${missing}`);
  process.exit(77);
}

for (const overlay of OVERLAYS) {
  test(`${overlay}: as rendered, it has the right types, its names lead somewhere, its pods have few rights`, () => {
    const objects = rendered(command, `overlays/${overlay}`);
    assert.equal(objects.length, written(`overlays/${overlay}`).length);
    check(objects);
    const namespaced = objects.filter(({ kind }) => kind !== 'Namespace');
    assert.deepEqual(new Set(namespaced.map(({ metadata }) => metadata.namespace)), new Set(['latvox']));
  });
}

test('batch: workers count as many workers as there are', () => {
  const { spec } = rendered(command, 'overlays/batch').find(({ kind }) => kind === 'Job');
  const { value } = spec.template.spec.containers[0].env.find(({ name }) => name === 'LATVOX_WORKER_COUNT');
  assert.equal(value, String(spec.completions));
});

test('the Secrets are as deploy/docs make them', () => withFiles((run) => {
  const page = ['kubernetes', 'gateway'].map((name) => readFileSync(new URL(`../../../deploy/docs/${name}.md`, import.meta.url), 'utf8')).join('');
  const made = page.match(/^kubectl .*create secret .*$/gm)
    .map((line) => JSON.parse(run('bash', '-c', `${line} --dry-run=client --output=json`)));
  assert.deepEqual(Object.fromEntries(made.map(({ metadata, data }) => [metadata.name, Object.keys(data).sort()])), SECRETS);
}));
