#!/usr/bin/env node
// The gateway; see README.md.
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { Gateway } from './gateway.js';
import { Log } from './log.js';
import { Metrics } from './metrics.js';
import { help, LIVE, readOptions } from './options.js';
import { Pages } from './pages.js';
import { Protocol } from './refusals.js';
import { Upstreams } from './upstreams.js';
import { Watched } from './watched.js';

const USAGE = 2;

function die(message) {
  process.stderr.write(`latvox-gateway: ${message}\n`);
  process.exit(USAGE);
}

const read = () => readOptions(process.argv.slice(2), process.env);
const differ = (one, other) => JSON.stringify(one) !== JSON.stringify(other);

function parts() {
  const options = read();
  if (options.help) {
    process.stdout.write(help());
    process.exit(0);
  }
  const file = options.protocol ?? fileURLToPath(new URL('protocol.binpb', import.meta.url));
  const log = new Log(options['log-level'], options['log-format']);
  const protocol = new Protocol(readFileSync(file)),
    watched = new Watched(log);
  watched.add({
    read: 'configuration_read',
    kept: 'reload_failed',
    paths: [options.config],
    use: configuration(options, log),
  });
  return {
    options,
    log,
    protocol,
    metrics: options['metrics-listen'] && new Metrics(protocol, log),
    upstreams: new Upstreams(options, log, watched),
    pages: new Pages(),
    watched,
  };
}

// Takes the options that may change from the configuration file, whenever that changes.
function configuration(options, log) {
  const started = { ...options };
  return () => {
    const now = read();
    for (const name of LIVE) options[name] = now[name];
    log.level = now['log-level'];
    const waiting = Object.keys(started).filter((name) => !LIVE.includes(name) && differ(started[name], now[name]));
    if (waiting.length > 0) log.write('warning', 'restart_needed', { options: waiting.join() });
    return { path: options.config };
  };
}

const named = ({ address, port }) => (address.includes(':') ? `[${address}]:${port}` : `${address}:${port}`);

let gateway;
try {
  gateway = new Gateway(parts());
  const { metrics, log, options } = gateway;
  if (metrics) log.write('info', 'metrics', { address: named(await metrics.serve(options['metrics-listen'])) });
  log.write('info', 'listening', { address: named(await gateway.listen()) });
  gateway.watched.start();
} catch (error) {
  die(error.message);
}

let stopping = false;
async function stop(signal) {
  if (stopping) return;
  stopping = true;
  gateway.log.write('info', 'stopping', {
    reason: signal,
    calls: gateway.calls.running.size,
    grace: `${gateway.options.grace}s`,
  });
  const cut = await gateway.stop();
  gateway.log.write('info', 'stopped', { calls_cut: cut });
  process.exit(0);
}
process.on('SIGHUP', () => gateway.watched.look());
for (const signal of ['SIGTERM', 'SIGINT']) process.on(signal, () => stop(signal));
