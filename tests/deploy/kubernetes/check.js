// Checks that every set of manifests must pass, and the files from which deploy/docs/kubernetes.md makes Secrets.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { brokenReferences, needlessRights } from './references.js';
import { typeErrors } from './types.js';

export const SECRETS = { 'latvox-tls': ['tls.crt', 'tls.key'], 'latvox-tokens': ['tokens'], 'latvox-gateway-tls': ['tls.crt', 'tls.key'] };

export function check(objects) {
  assert.deepEqual(typeErrors(objects), []);
  assert.deepEqual(brokenReferences(objects, SECRETS), []);
  assert.deepEqual(needlessRights(objects), []);
}

// Runs `use(run, directory)` in a directory with these files.
export function withFiles(use) {
  const directory = mkdtempSync(path.join(tmpdir(), 'latvox-manifests-'));
  const run = (command, ...words) => execFileSync(command, words, { encoding: 'utf8', cwd: directory, stdio: ['ignore', 'pipe', 'pipe'] });
  try {
    run('openssl', 'req', '-x509', '-newkey', 'rsa:2048', '-nodes', '-subj', '/CN=localhost', '-keyout', 'key.pem', '-out', 'certificate.pem');
    writeFileSync(path.join(directory, 'tokens'), `alice sha256:${'0123456789abcdef'.repeat(4)}\n`, { mode: 0o600 });
    return use(run, directory);
  } finally {
    rmSync(directory, { recursive: true });
  }
}

// Returns the settings that latvoxd finds in the configuration file: name -> text.
export const settings = (text) => withFiles((run, directory) => {
  const files = { 'tls/server.pem.key': 'key.pem', 'tls/server.pem': 'certificate.pem', 'tokens/tokens': 'tokens' };
  for (const [inside, file] of Object.entries(files)) text = text.replaceAll(`/run/secrets/latvox/${inside}`, file);
  writeFileSync(path.join(directory, 'latvoxd.toml'), text);
  const told = run(path.join(process.env.LATVOX_BIN, 'latvoxd'), '--check-config', '--config', 'latvoxd.toml');
  return Object.fromEntries([...told.matchAll(/^(\S+) = (.*?) +# file /gm)].map(([, name, value]) => [name, value.replace(/^(\["|")|("\]|")$/g, '')]));
});
