// Checks of a set of objects that types cannot express: names resolve, and pods have no unneeded rights.

const named = (objects, kind) => objects.filter((object) => object.kind === kind);
const podTemplates = (objects) => objects.filter(({ kind }) => kind === 'Deployment' || kind === 'Job')
  .map(({ kind, metadata, spec }) => ({ name: `${kind} ${metadata.name}`, labels: spec.template.metadata.labels, pod: spec.template.spec }));
const matches = (selector, labels = {}) => Object.entries(selector ?? {}).every(([key, value]) => labels[key] === value);
const below = (folder, file) => file.startsWith(`${folder}/`);

// Returns lines for people, none if all is well. `secrets` maps the names of Secrets, which are not in the tree, to
// their keys.
export function brokenReferences(objects, secrets) {
  const pods = podTemplates(objects);
  return [
    ...pods.flatMap((pod) => [...brokenVolumes(pod, objects, secrets), ...brokenPaths(pod, objects, secrets), ...brokenProbes(pod)]),
    ...brokenSelectors(objects, pods),
    ...brokenPorts(objects, pods),
  ];
}

function brokenVolumes({ name, pod }, objects, secrets) {
  const volumes = pod.volumes.map((volume) => volume.name);
  const mounts = pod.containers.flatMap(({ volumeMounts }) => volumeMounts.map((mount) => mount.name));
  const has = (kind, wanted) => named(objects, kind).some(({ metadata }) => metadata.name === wanted);
  return [
    ...mounts.filter((mount) => !volumes.includes(mount)).map((mount) => `${name} mounts ${mount}, which is no volume`),
    ...volumes.filter((volume) => !mounts.includes(volume)).map((volume) => `${name} does not mount ${volume}`),
    ...pod.volumes.flatMap(({ configMap, secret, persistentVolumeClaim }) => [
      configMap && !has('ConfigMap', configMap.name) && `${name}: there is no ConfigMap ${configMap.name}`,
      secret && !secrets[secret.secretName] && `${name}: there is no Secret ${secret.secretName}`,
      persistentVolumeClaim && !has('PersistentVolumeClaim', persistentVolumeClaim.claimName) &&
        `${name}: there is no PersistentVolumeClaim ${persistentVolumeClaim.claimName}`,
    ].filter(Boolean)),
    ...(has('ServiceAccount', pod.serviceAccountName) ? [] : [`${name}: there is no ServiceAccount ${pod.serviceAccountName}`]),
  ];
}

// The files that a container finds below each mount point; null: any file.
function filesOf({ pod }, container, objects, secrets) {
  return container.volumeMounts.map((mount) => {
    const { configMap, secret } = pod.volumes.find((volume) => volume.name === mount.name) ?? {};
    const map = configMap && named(objects, 'ConfigMap').find(({ metadata }) => metadata.name === configMap.name);
    return { at: mount.mountPath, keys: map ? Object.keys(map.data) : secret ? secret.items?.map((item) => item.path) ?? secrets[secret.secretName] ?? [] : null };
  });
}

// Every absolute path in the command, and in the configuration that it names, is a file of a volume.
function brokenPaths(template, objects, secrets) {
  return template.pod.containers.flatMap((container) => {
    const files = filesOf(template, container, objects, secrets);
    const exists = (file) => files.some(({ at, keys }) =>
      keys === null ? file === at || below(at, file) : keys.some((key) => file === `${at}/${key}`));
    const paths = container.command.slice(1).filter((word) => word.startsWith('/'));
    const texts = named(objects, 'ConfigMap').flatMap(({ data }) => Object.values(data));
    const inTexts = container.command.includes('--config') ? texts.flatMap((text) => text.match(/(?<=")\/[^"]+(?=")/g) ?? []) : [];
    return [...paths, ...inTexts].filter((file) => !exists(file)).map((file) => `${template.name}: no volume has ${file}`);
  });
}

function brokenProbes({ name, pod }) {
  return pod.containers.flatMap(({ ports = [], startupProbe, readinessProbe, livenessProbe }) =>
    [startupProbe, readinessProbe, livenessProbe].filter(Boolean)
      .map(({ grpc, tcpSocket, httpGet }) => (grpc ?? tcpSocket ?? httpGet).port)
      .filter((port) => !ports.some(({ containerPort }) => containerPort === port))
      .map((port) => `${name}: a probe asks port ${port}, which no container has`));
}

function brokenSelectors(objects, pods) {
  const selects = (selector) => pods.some(({ labels }) => matches(selector, labels));
  const wrong = (kind, selectorOf) => named(objects, kind).filter((object) => !selects(selectorOf(object)))
    .map(({ metadata }) => `${kind} ${metadata.name} selects no pod`);
  const targets = named(objects, 'HorizontalPodAutoscaler').map(({ metadata, spec }) => ({ metadata, ...spec.scaleTargetRef }));
  return [
    ...wrong('Deployment', ({ spec }) => spec.selector.matchLabels),
    ...wrong('Service', ({ spec }) => spec.selector),
    ...wrong('PodDisruptionBudget', ({ spec }) => spec.selector.matchLabels),
    ...wrong('NetworkPolicy', ({ spec }) => spec.podSelector.matchLabels),
    ...targets.filter(({ kind, name }) => !named(objects, kind).some(({ metadata }) => metadata.name === name))
      .map(({ metadata, kind, name }) => `HorizontalPodAutoscaler ${metadata.name}: there is no ${kind} ${name}`),
    ...named(objects, 'ServiceMonitor')
      .filter(({ spec }) => !named(objects, 'Service').some(({ metadata }) => matches(spec.selector.matchLabels, metadata.labels)))
      .map(({ metadata }) => `ServiceMonitor ${metadata.name} selects no Service`),
    ...pods.flatMap(({ name, labels, pod }) => pod.topologySpreadConstraints
      .filter(({ labelSelector }) => !matches(labelSelector.matchLabels, labels)).map(() => `${name} is spread among other pods`)),
  ];
}

function brokenPorts(objects, pods) {
  const ofPods = pods.flatMap(({ pod }) => pod.containers.flatMap(({ ports = [] }) => ports.map(({ name }) => name)));
  const ofServices = named(objects, 'Service').flatMap(({ spec }) => spec.ports.map(({ name }) => name));
  const wanted = [
    ...named(objects, 'Service').flatMap(({ spec }) => spec.ports.map(({ targetPort }) => ['Service', targetPort, ofPods])),
    ...named(objects, 'NetworkPolicy').flatMap(({ spec }) =>
      (spec.ingress ?? []).flatMap(({ ports }) => ports.map(({ port }) => ['NetworkPolicy', port, ofPods]))),
    ...named(objects, 'ServiceMonitor').flatMap(({ spec }) => spec.endpoints.map(({ port }) => ['ServiceMonitor', port, ofServices])),
  ];
  return wanted.filter(([, port, ports]) => !ports.includes(port)).map(([kind, port]) => `${kind}: there is no port ${port}`);
}

// The pod security standard "restricted", and a read-only root file system.
export function needlessRights(objects) {
  return podTemplates(objects).flatMap(({ name, pod }) => [
    pod.securityContext.runAsNonRoot === true || `${name} may run as root`,
    pod.securityContext.seccompProfile.type === 'RuntimeDefault' || `${name} has no seccomp profile`,
    pod.automountServiceAccountToken === false || `${name} gets a token`,
    ...pod.containers.flatMap(({ securityContext: rights, resources }) => [
      rights.allowPrivilegeEscalation === false || `${name} may gain privileges`,
      rights.readOnlyRootFilesystem === true || `${name} may write its root file system`,
      rights.capabilities.drop.includes('ALL') || `${name} keeps capabilities`,
      Boolean(resources.limits.cpu && resources.limits.memory) || `${name} has no limits`,
    ]),
  ]).filter((problem) => problem !== true);
}
