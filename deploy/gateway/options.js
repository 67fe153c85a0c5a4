// The options of the gateway: flags, environment variables, or lines of a configuration file. A flag wins over its
// variable, and that over the file.
import { parseArgs } from 'node:util';
import { parse } from 'smol-toml';
import { readSmallFileSync } from './small_file.js';

const PREFIX = 'LATVOX_GATEWAY_';

const whole = (least, most) => (text) => {
  if (!/^\d+$/.test(text)) throw new Error(`"${text}" is not a whole number`);
  return within(Number(text), least, most);
};

function within(number, least, most) {
  if (number < least || number > most) throw new Error(`${number} is not between ${least} and ${most}`);
  return number;
}

const seconds = (text) => {
  if (!/^\d+(\.\d+)?$/.test(text)) throw new Error(`"${text}" is not a number of seconds`);
  return within(Number(text), 0, 86400);
};

const size = (text) => {
  const [, number, unit] = text.match(/^(\d+)(KiB|MiB|GiB)?$/) ?? [];
  if (number === undefined) throw new Error(`"${text}" is not a size such as 6291456 or 6MiB`);
  return within(number * 1024 ** ['', 'KiB', 'MiB', 'GiB'].indexOf(unit ?? ''), 1024, 2 ** 40);
};

const oneOf =
  (...words) =>
  (text) => {
    if (!words.includes(text)) throw new Error(`"${text}" is not one of ${words.join(', ')}`);
    return text;
  };

const tcp = (text) => {
  const [, bracketed, plain, port] = text.match(/^(?:\[([0-9a-fA-F:]+)\]|([^:\s]+)):(\d+)$/) ?? [];
  if (port === undefined) throw new Error(`"${text}" is not HOST:PORT`);
  return { host: bracketed ?? plain, port: within(Number(port), 0, 65535) };
};

const upstreams = (text) => text.split(',').map((one) => (one.startsWith('unix:') ? { path: one.slice(5) } : tcp(one)));

const origins = (text) =>
  (text === '' ? [] : text.split(',')).map((origin) => {
    if (origin === '*') return origin;
    let found;
    try {
      found = new URL(origin).origin;
    } catch {
      found = null;
    }
    if (found !== origin) throw new Error(`"${origin}" is neither * nor an origin such as https://example.org`);
    return origin;
  });

const text = (value) => value;

// Those that apply at once when the configuration file changes.
export const LIVE = ['cors-origin', 'log-level'];

// name: [kind of value, reader, default, help]
const OPTIONS = {
  listen: ['HOST:PORT', tcp, '127.0.0.1:8080', 'Address to serve'],
  insecure: ['', null, false, 'Serve other machines in plain text'],
  'tls-cert': ['FILE', text, null, 'Certificate chain (PEM); turns on TLS with HTTP/2'],
  'tls-key': ['FILE', text, null, 'Key of --tls-cert (PEM)'],
  upstream: [
    'ADDRESS,...',
    upstreams,
    '127.0.0.1:50151',
    'latvoxd: HOST:PORT or unix:PATH; of several, each mesh has one',
  ],
  'upstream-tls': ['', null, false, 'Use TLS towards --upstream'],
  'upstream-ca': ['FILE', text, null, 'Roots (PEM) of --upstream, in place of those of the system'],
  'upstream-cert': ['FILE', text, null, 'Certificate (PEM) to show to --upstream'],
  'upstream-key': ['FILE', text, null, 'Key of --upstream-cert (PEM)'],
  config: ['FILE', text, null, 'Configuration (TOML) with these options by name; see deploy/docs/gateway.md'],
  'cors-origin': ['ORIGIN,...', origins, [], 'Origins whose pages may call, or *'],
  'metrics-listen': ['HOST:PORT', tcp, null, 'Address of /metrics for Prometheus, in plain text'],
  'max-body': ['SIZE', size, '6MiB', 'Largest body of a request; a message of 4 MiB takes 5.4 MiB as JSON'],
  'max-bodies': ['SIZE', size, '256MiB', 'Bodies of all requests at once'],
  'max-calls': ['N', whole(1, 100000), '256', 'Calls at once'],
  'max-connections': ['N', whole(1, 1000000), '1024', 'Connections of clients at once'],
  'stall-timeout': [
    'SECONDS',
    seconds,
    '60',
    'Time after which a client is dropped that does not read the end of its answer',
  ],
  grace: ['SECONDS', seconds, '10', 'Time for running calls to end after SIGTERM or SIGINT'],
  protocol: ['FILE', text, null, 'Description of the protocol; default: protocol.binpb beside the program'],
  'log-level': [
    'LEVEL',
    oneOf('debug', 'info', 'warning', 'error', 'off'),
    'info',
    'Lowest severity of lines in the log',
  ],
  'log-format': ['FORMAT', oneOf('text', 'json'), 'text', 'text or json'],
  help: ['', null, false, 'Print this help and exit'],
};

const variableOf = (name) => PREFIX + name.toUpperCase().replaceAll('-', '_');

export function help() {
  const lines = Object.entries(OPTIONS).map(([name, [kind, read, otherwise, what]]) => {
    const usual = read && otherwise !== null && String(otherwise) !== '' ? ` (default: ${otherwise})` : '';
    return `  ${`--${name} ${kind}`.padEnd(28)}${what}${usual}`;
  });
  return (
    'Serve latvoxd to browsers: gRPC-Web, Connect, JSON, and a page\n\nUsage: main.js [OPTIONS]\n\n' +
    `${lines.join('\n')}\n\n` +
    `Each option is also an environment variable: --max-calls, ${variableOf('max-calls')}.\n`
  );
}

function truth(text) {
  if (!['true', 'false'].includes(text)) throw new Error(`"${text}" is not one of true, false`);
  return text === 'true';
}

function flags(words) {
  const options = Object.fromEntries(
    Object.entries(OPTIONS).map(([name, [, read]]) => [name, { type: read ? 'string' : 'boolean' }]),
  );
  return parseArgs({ args: words, options, allowPositionals: false }).values;
}

// Returns the texts of a configuration file by the names of their options.
function settingsOf(path) {
  let table;
  try {
    table = parse(readSmallFileSync(path));
  } catch (error) {
    if (!error.line) throw new Error(`--config: ${error.message}`);
    throw new Error(`${path}:${error.line}: ${error.message.split('\n')[0]}`);
  }
  const shown = (value) => (value instanceof Date ? value.toISOString() : JSON.stringify(value));
  const plain = (value) => ['string', 'number', 'boolean'].includes(typeof value);
  for (const [name, value] of Object.entries(table)) {
    if (!Object.hasOwn(OPTIONS, name) || ['help', 'config'].includes(name))
      throw new Error(`${path}: unknown key "${name}"`);
    if (![value].flat().every(plain))
      throw new Error(`${path}: ${name}: ${shown(value)} is no text, number, true or false, nor a list of them`);
  }
  return Object.fromEntries(Object.entries(table).map(([name, value]) => [name, String(value)]));
}

// `sources`: a flag, a variable and a line of the configuration file, each with the name for errors.
function read(name, sources) {
  const [, reader, otherwise] = OPTIONS[name];
  const [given, source] = sources.find(([value]) => value !== undefined) ?? [];
  try {
    if (!reader) return given === undefined ? false : given === true || truth(given);
    if (given === undefined && typeof otherwise !== 'string') return otherwise;
    return reader(given ?? otherwise);
  } catch (error) {
    throw new Error(`${source}: ${error.message}`);
  }
}

// Throws an Error for an option that lacks the one that it needs, and for one that contradicts another.
function check(options) {
  const needs = [
    ['tls-cert', 'tls-key'],
    ['tls-key', 'tls-cert'],
    ['upstream-cert', 'upstream-key'],
    ['upstream-key', 'upstream-cert'],
    ['upstream-ca', 'upstream-tls'],
    ['upstream-cert', 'upstream-tls'],
  ];
  for (const [one, other] of needs) if (options[one] && !options[other]) throw new Error(`--${one} needs --${other}`);
  const { host } = options.listen,
    local = /^(127\.|::1$|localhost$)/.test(host);
  if (!local && !options['tls-cert'] && !options.insecure) {
    throw new Error(`--listen: ${host} reaches other machines; give --tls-cert and --tls-key, or --insecure`);
  }
  if (options['max-body'] > options['max-bodies']) {
    throw new Error(`--max-body: ${options['max-body']} exceeds --max-bodies, ${options['max-bodies']}`);
  }
  return options;
}

// Returns the options by their names. Throws an Error that names the option, its value and its limit.
export function readOptions(words, environment) {
  for (const name of Object.keys(environment)) {
    const option = name.startsWith(PREFIX) ? name.slice(PREFIX.length).toLowerCase().replaceAll('_', '-') : 'help';
    if (!Object.hasOwn(OPTIONS, option)) throw new Error(`${name}: there is no such option`);
  }
  const given = flags(words),
    path = given.config ?? environment[variableOf('config')];
  const lines = path === undefined ? {} : settingsOf(path);
  const sourcesOf = (name) => [
    [given[name], `--${name}`],
    [environment[variableOf(name)], variableOf(name)],
    [lines[name], `${path}: ${name}`],
  ];
  return check(Object.fromEntries(Object.keys(OPTIONS).map((name) => [name, read(name, sourcesOf(name))])));
}
