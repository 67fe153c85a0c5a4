// Checks the output of kustomize for deploy/kubernetes, and the Secrets of deploy/docs. Exits with 77,
// ctest's "skipped", without kustomize or kubectl.
import assert from 'node:assert/strict';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { check, SECRETS, withFiles } from './check.js';
import { findKustomize, kubectlMissing, kustomization, lone, OVERLAYS, rendered, ROOT, written } from './documents.js';

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

// Renders the folder `site` with components beside its own, and with other values, in a copy of deploy/kubernetes. `own`:
// the texts of a component's files, by their names.
function site({ before = [], after = [], own = {}, change = (values) => values }) {
  const root = mkdtempSync(path.join(tmpdir(), 'latvox-site-'));
  try {
    cpSync(ROOT, root, { recursive: true });
    mkdirSync(path.join(root, 'components/own'));
    for (const [name, text] of Object.entries(own)) writeFileSync(path.join(root, 'components/own', name), text);
    const components = [...before, 'values', ...after].map((name) => `../components/${name}`);
    writeFileSync(path.join(root, 'site/kustomization.yaml'), JSON.stringify({ ...kustomization('site'), components }));
    const [values] = lone('site/values.yaml');
    writeFileSync(path.join(root, 'site/values.yaml'), JSON.stringify({ ...values, data: change(values.data) }));
    return rendered(command, 'site', root);
  } finally {
    rmSync(root, { recursive: true });
  }
}
const deployment = (objects, wanted) => objects.find(({ kind, metadata: { name } }) => kind === 'Deployment' && name === wanted);
const byName = (objects) => Object.fromEntries(objects.map((object) => [`${object.kind}/${object.metadata.name}`, object]));

test('site: as it is, it equals the overlay `service`, and with the gateway, that of the gateway as well', () => {
  const service = rendered(command, 'overlays/service');
  assert.deepEqual(rendered(command, 'site'), service);
  assert.deepEqual(byName(site({ before: ['gateway'] })), byName([...service, ...rendered(command, 'overlays/gateway')]));
});

test('site: each value is in its places, and there alone', () => {
  const data = { image: 'registry.example/latvox:1', minPods: '3', maxPods: '7', cpu: '16', memory: '11Gi', tokensSecret: 'some-tokens',
    tlsSecret: 'some-tls', haproxyImage: 'registry.example/haproxy:2', gatewayImage: 'registry.example/gateway:3', gatewayPods: '5', gatewayTlsSecret: 'web-tls' };
  const found = byName(site({ before: ['gateway'], change: (values) => {
    assert.deepEqual(Object.keys(values).sort(), Object.keys(data).sort());
    return data;
  } }));
  const expected = byName(site({ before: ['gateway'] }));
  const { spec: { template: { spec: pod } } } = expected['Deployment/latvox'], gateway = expected['Deployment/latvox-gateway'].spec;
  Object.assign(expected['HorizontalPodAutoscaler/latvox'].spec, { minReplicas: 3, maxReplicas: 7 });
  const [latvoxd, haproxy] = ['latvoxd', 'haproxy'].map((name) => pod.containers.find((container) => container.name === name));
  Object.assign(latvoxd, { image: data.image, resources: { requests: { cpu: '16', memory: '11Gi' }, limits: { cpu: '16', memory: '11Gi' } } });
  haproxy.image = data.haproxyImage;
  const secret = ({ volumes }, wanted) => volumes.find(({ name }) => name === wanted).secret;
  secret(pod, 'tokens').secretName = 'some-tokens';
  secret(pod, 'tls').secretName = 'some-tls';
  gateway.replicas = 5;
  gateway.template.spec.containers[0].image = data.gatewayImage;
  secret(gateway.template.spec, 'roots').secretName = 'some-tls';
  secret(gateway.template.spec, 'tls').secretName = 'web-tls';
  assert.deepEqual(found, expected);
});

test('site: a value that is missing is an error that names it', () => {
  for (const name of Object.keys(lone('site/values.yaml')[0].data)) {
    const change = ({ [name]: _, ...others }) => others;
    assert.throws(() => site({ change }), new RegExp(`data\\.${name}.*is missing`), name);
  }
});

test('site: without haproxy, latvoxd has the port and the certificate; without the operator, there is no monitor', () => {
  const objects = site({ before: ['gateway'], after: ['direct-tls', 'without-monitor'] });
  check(objects);
  const { containers } = deployment(objects, 'latvox').spec.template.spec;
  assert.deepEqual(containers.map(({ name, ports }) => [name, ports.map((port) => port.name).sort()]), [['latvoxd', ['grpc', 'health', 'metrics']]]);
  assert.deepEqual(objects.filter(({ kind }) => kind === 'ConfigMap').map(({ metadata }) => metadata.name.replace(/-[^-]*$/, '')), ['latvoxd']);
  assert.deepEqual(objects.filter(({ kind }) => kind === 'ServiceMonitor'), []);
});

test('site: options of latvoxd in a component of its own that is listed last are those of latvoxd', () => {
  const generator = { name: 'latvoxd', behavior: 'replace', files: ['latvoxd.toml'] };
  const component = { apiVersion: 'kustomize.config.k8s.io/v1alpha1', kind: 'Component', configMapGenerator: [generator] };
  const own = { 'latvoxd.toml': 'tls-client-ca = "roots.pem"\n', 'kustomization.yaml': JSON.stringify(component) };
  for (const after of [['own'], ['direct-tls', 'own']]) {
    const maps = site({ after, own }).filter(({ kind, metadata }) => kind === 'ConfigMap' && metadata.name.startsWith('latvoxd-'));
    assert.deepEqual(maps.map(({ data }) => data['latvoxd.toml']), [own['latvoxd.toml']]);
  }
});

test('the Secrets are as deploy/docs make them', () => withFiles((run) => {
  const page = ['kubernetes', 'gateway'].map((name) => readFileSync(new URL(`../../../deploy/docs/${name}.md`, import.meta.url), 'utf8')).join('');
  const made = page.match(/^kubectl .*create secret .*$/gm)
    .map((line) => JSON.parse(run('bash', '-c', `${line} --dry-run=client --output=json`)));
  assert.deepEqual(Object.fromEntries(made.map(({ metadata, data }) => [metadata.name, Object.keys(data).sort()])), SECRETS);
}));
