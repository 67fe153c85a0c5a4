// The manifests of deploy/kubernetes have the API's types, are consistent, and configure latvoxd correctly. These tests
// read them as written; kustomize.test.js reads them as rendered. Needs LATVOX_BIN.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { readOptions } from '../../../deploy/gateway/options.js';
import { check, SECRETS, settings, withFiles } from './check.js';
import { findKustomize, lone, OVERLAYS, ROOT, written } from './documents.js';
import { brokenReferences, needlessRights } from './references.js';
import { typeErrors } from './types.js';

const load = (overlay) => written(`overlays/${overlay}`);
const find = (objects, kind) => objects.find((object) => object.kind === kind);
const named = (objects, kind, name) => objects.find((object) => object.kind === kind && object.metadata.name === name);

for (const overlay of OVERLAYS) {
  test(`${overlay}: as written, it has the right types, its names lead somewhere, its pods have few rights`, () => check(load(overlay)));
}

const names = (objects) => objects.map(({ kind, metadata }) => `${kind}/${metadata.name}`).sort();

test('each overlay has all of its objects', () => {
  const base = ['Namespace/latvox', 'NetworkPolicy/deny', 'ServiceAccount/latvox'];
  assert.deepEqual(names(load('service')), [...base, 'ConfigMap/haproxy', 'ConfigMap/latvoxd', 'Deployment/latvox', 'HorizontalPodAutoscaler/latvox',
    'NetworkPolicy/latvoxd', 'PodDisruptionBudget/latvox', 'Service/latvox', 'ServiceMonitor/latvox'].sort());
  assert.deepEqual(names(load('batch')), [...base, 'Job/latvox-batch', 'PersistentVolumeClaim/latvox-meshes',
    'PersistentVolumeClaim/latvox-results'].sort());
  assert.deepEqual(names(load('gateway')), [...base, 'Deployment/latvox-gateway', 'NetworkPolicy/latvox-gateway',
    'PodDisruptionBudget/latvox-gateway', 'Service/latvox-gateway', 'ServiceMonitor/latvox-gateway'].sort());
});

test('batch: a worker is tried again by itself, but not for what stays wrong, and its pod asks for what it takes', () => {
  const { spec } = find(load('batch'), 'Job');
  assert.equal(spec.backoffLimitPerIndex, 3);
  assert.deepEqual(spec.podFailurePolicy.rules.map(({ action }) => action), ['Ignore', 'FailIndex']);
  assert.deepEqual(spec.podFailurePolicy.rules[1].onExitCodes.values, [2, 3]);
  const { requests, limits } = spec.template.spec.containers[0].resources;
  assert.deepEqual(requests, limits);
});

test('the loader may do as little as the workers, whose volumes it fills', () => {
  const [loader] = lone('loader.yaml');
  const claims = load('batch').filter(({ kind }) => kind === 'PersistentVolumeClaim');
  assert.deepEqual(typeErrors([loader]), []);
  assert.deepEqual(loader.spec.volumes.map((volume) => volume.persistentVolumeClaim.claimName).sort(),
    claims.map(({ metadata }) => metadata.name).sort());
  const worker = podOf(find(load('batch'), 'Job'));
  assert.equal(loader.spec.securityContext.runAsUser, worker.securityContext.runAsUser);
  const { spec: template, metadata } = loader;
  const wrapped = { apiVersion: 'batch/v1', kind: 'Job', metadata, spec: { template: { metadata: {}, spec: template } } };
  assert.deepEqual(needlessRights([wrapped]), []);
});

test('service: latvoxd takes its configuration, which has the ports and the times of the pod', () => {
  const objects = load('service');
  const text = find(objects, 'ConfigMap').data['latvoxd.toml'];
  const found = settings(text);
  assert.equal(Object.keys(found).length, text.match(/^[a-z-]+ = /gm).length, 'every line of it counts');
  const { terminationGracePeriodSeconds, containers: [container] } = find(objects, 'Deployment').spec.template.spec;
  const ports = Object.fromEntries(container.ports.map(({ name, containerPort }) => [name, String(containerPort)]));
  assert.deepEqual({ health: found['health-listen'], metrics: found['metrics-listen'] }, { health: `[::]:${ports.health}`, metrics: `0.0.0.0:${ports.metrics}` });
  assert.equal(container.readinessProbe.grpc.port, Number(ports.health), 'probes know no TLS');
  const lastResort = 15;  // seconds that latvoxd may take after --grace
  assert.ok(terminationGracePeriodSeconds >= Number(found.grace) + container.lifecycle.preStop.sleep.seconds + lastResort);
});

test('direct-tls: latvoxd takes its configuration, which is that behind haproxy, without the proxy, and with a certificate', () => {
  const found = settings(readFileSync(path.join(ROOT, 'components/direct-tls/latvoxd.toml'), 'utf8'));
  const { 'tls-cert': certificate, 'tls-key': key, ...rest } = found;
  assert.deepEqual([certificate, key], ['certificate.pem', 'key.pem']);
  const { 'behind-proxy': proxied, ...behind } = settings(named(load('service'), 'ConfigMap', 'latvoxd').data['latvoxd.toml']);
  assert.equal(proxied, 'true');
  assert.deepEqual(rest, { ...behind, listen: '[::]:50151' });
});

test('service: haproxy takes its configuration, serves its port, finds its files, and leads to latvoxd', () => {
  const objects = load('service');
  const text = named(objects, 'ConfigMap', 'haproxy').data['haproxy.cfg'];
  const { terminationGracePeriodSeconds, containers: [, container], volumes } = find(objects, 'Deployment').spec.template.spec;
  const [, port, file] = text.match(/bind :::(\d+) v4v6 ssl crt (\S+) /);
  assert.equal(Number(port), container.ports[0].containerPort);
  const { name } = container.volumeMounts.find(({ mountPath }) => mountPath === path.dirname(file));
  const keys = volumes.find((volume) => volume.name === name).secret.items.map((item) => item.path);
  assert.deepEqual(keys, [path.basename(file), `${path.basename(file)}.key`]);
  const found = settings(named(objects, 'ConfigMap', 'latvoxd').data['latvoxd.toml']), metrics = found['metrics-listen'].split(':')[1];
  assert.equal(text.match(/server latvoxd (\S+) /)[1], found.listen);
  assert.match(text, new RegExp(`bind :::${metrics} v6only\\n.*\\nbackend metrics\\n    server latvoxd 127\\.0\\.0\\.1:${metrics}\\n`));
  assert.ok(terminationGracePeriodSeconds >= Number(text.match(/hard-stop-after (\d+)s/)[1]) + container.lifecycle.preStop.sleep.seconds);
  withFiles((run, directory) => {
    run('cp', 'certificate.pem', 'server.pem');
    run('cp', 'key.pem', 'server.pem.key');
    writeFileSync(path.join(directory, 'haproxy.cfg'), text.replace(file, path.join(directory, 'server.pem')));
    run('haproxy', '-c', '-f', 'haproxy.cfg');
  });
});

test('gateway: it takes its options, and calls the pods of the overlay service by a name that their certificate has', () => {
  const deployment = find(load('gateway'), 'Deployment'), { terminationGracePeriodSeconds, containers: [container] } = deployment.spec.template.spec;
  const words = container.command.slice(1).map((word) => (word.startsWith('/run/') ? 'certificate.pem' : word));
  const { listen, upstream, grace, 'metrics-listen': metrics } = readOptions(words, {});
  assert.deepEqual([listen.host, metrics.host], ['::', '::'], 'IPv6 and IPv4');
  const ports = Object.fromEntries(container.ports.map(({ name, containerPort }) => [name, containerPort]));
  assert.deepEqual(ports, { https: listen.port, metrics: metrics.port });
  const service = find(load('service'), 'Service');
  assert.deepEqual(upstream, [{ host: `${service.metadata.name}.latvox.svc`, port: service.spec.ports[0].port }]);
  assert.ok(terminationGracePeriodSeconds >= grace + container.lifecycle.preStop.sleep.seconds);
});

// The tests find mistakes that are put into the manifests.
function changed(overlay, kind, change) {
  const objects = load(overlay);
  change(find(objects, kind), objects);
  return objects;
}
const podOf = ({ spec }) => spec.template.spec;

test('wrong types are found', () => {
  const mistakes = [
    [/replica/, 'service', 'Deployment', ({ spec }) => { spec.replica = 3; }],
    [/string.*number/, 'batch', 'Job', ({ spec }) => { spec.completions = '64'; }],
    [/template.*missing/, 'batch', 'Job', ({ spec }) => { delete spec.template; }],
    [/intervall/, 'service', 'ServiceMonitor', ({ spec }) => { spec.endpoints[0].intervall = '15s'; }],
    [/Cannot find module.*v2/, 'service', 'Service', (service) => { service.apiVersion = 'v2'; }],
  ];
  const errors = typeErrors(mistakes.map(([, overlay, kind, change]) => find(changed(overlay, kind, change), kind)));
  for (const [says] of mistakes) assert.ok(errors.some((error) => says.test(error)), `${says} is not among ${errors.join('\n')}`);
  assert.equal(errors.length, mistakes.length, errors.join('\n'));
});

test('names that lead nowhere are found', () => {
  for (const [says, overlay, kind, change] of [
    ['there is no ConfigMap latvoxd', 'service', 'ConfigMap', (map) => { map.metadata.name = 'other'; }],
    ['no volume has /etc/latvox/latvoxd.toml', 'service', 'ConfigMap', (map) => { map.data = { other: '' }; }],
    ['no volume has /x/y', 'service', 'ConfigMap', ({ data }) => { data['latvoxd.toml'] += 'tls-client-ca = "/x/y"\n'; }],
    ['there is no Secret latvox-tlss', 'service', 'Deployment', (o) => { podOf(o).volumes[2].secret.secretName = 'latvox-tlss'; }],
    ['a probe asks port 1', 'service', 'Deployment', (o) => { podOf(o).containers[0].livenessProbe.grpc.port = 1; }],
    ['does not mount tls', 'service', 'Deployment', (o) => { podOf(o).containers[1].volumeMounts.splice(1, 1); }],
    ['there is no ServiceAccount', 'service', 'ServiceAccount', ({ metadata }) => { metadata.name = 'other'; }],
    ['Service latvox selects no pod', 'service', 'Service', ({ spec }) => { spec.selector = { app: 'latvox' }; }],
    ['ServiceMonitor latvox selects no Service', 'service', 'Service', ({ metadata }) => { delete metadata.labels; }],
    ['PodDisruptionBudget latvox selects', 'service', 'PodDisruptionBudget', ({ spec }) => { spec.selector.matchLabels.x = 'y'; }],
    ['there is no Deployment other', 'service', 'HorizontalPodAutoscaler', ({ spec }) => { spec.scaleTargetRef.name = 'other'; }],
    ['NetworkPolicy: there is no port grpc', 'service', 'Deployment', (o) => { podOf(o).containers[1].ports[0].name = 'rpc'; }],
    ['ServiceMonitor: there is no port metrics', 'service', 'Service', ({ spec }) => { spec.ports.pop(); }],
    ['there is no PersistentVolumeClaim latvox-meshes', 'batch', 'PersistentVolumeClaim', ({ metadata }) => { metadata.name = 'x'; }],
    ['no volume has /results', 'batch', 'Job', (o) => { podOf(o).containers[0].volumeMounts[1].mountPath = '/result'; }],
    ['is spread among other pods', 'batch', 'Job', ({ spec }) => { spec.template.metadata.labels = {}; }],
  ]) {
    const broken = brokenReferences(changed(overlay, kind, change), SECRETS);
    assert.ok(broken.some((line) => line.includes(says)), `${says} is not among ${JSON.stringify(broken)}`);
  }
});

test('needless rights are found', () => {
  for (const change of [
    (pod) => { pod.securityContext.runAsNonRoot = false; },
    (pod) => { pod.securityContext.seccompProfile.type = 'Unconfined'; },
    (pod) => { delete pod.automountServiceAccountToken; },
    (pod) => { pod.containers[0].securityContext.allowPrivilegeEscalation = true; },
    (pod) => { delete pod.containers[0].securityContext.readOnlyRootFilesystem; },
    (pod) => { pod.containers[0].securityContext.capabilities.drop = []; },
    (pod) => { delete pod.containers[0].resources.limits.memory; },
  ]) {
    assert.equal(needlessRights(changed('batch', 'Job', (job) => change(podOf(job)))).length, 1, String(change));
  }
});

test('kustomize 5 is found by what it tells, Debian\'s too', () => {
  const folder = mkdtempSync(path.join(tmpdir(), 'latvox-kustomize-')), before = process.env.PATH;
  try {
    process.env.PATH = folder;
    for (const [program, told, command] of [
      ['kustomize', 'v5.6.0', ['kustomize', 'build']],
      ['kustomize', '(devel)', ['kustomize', 'build']],
      ['kustomize', 'v4.5.7'],
      ['kubectl', 'Client Version: v1.32.3\nKustomize Version: v5.5.0', ['kubectl', 'kustomize']],
      ['kubectl', 'Client Version: v5.0.0\nKustomize Version: v4.5.7'],
    ]) {
      writeFileSync(path.join(folder, program), `#!/bin/sh\necho '${told}'\n`, { mode: 0o755 });
      assert.deepEqual(findKustomize().command, command, told);
      rmSync(path.join(folder, program));
    }
  } finally {
    process.env.PATH = before;
    rmSync(folder, { recursive: true });
  }
});
