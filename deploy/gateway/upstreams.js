// Connections to latvoxd, and the choice among several servers.
import { createHash } from 'node:crypto';
import { promises as dns } from 'node:dns';
import net from 'node:net';
import { createGrpcTransport, Http2SessionManager } from '@connectrpc/connect-node';
import { certificateOf, checkPair } from './certificates.js';

const STREAMS = 200; // calls on a connection; latvoxd takes 256
const PAUSE = 1000; // milliseconds without calls for a server that could not be reached
const RESOLVE = 5000; // milliseconds between looks at the addresses of a name

const bracketed = (address, port) => `${address.includes(':') ? `[${address}]` : address}:${port}`;

// A server: a path, or an address and the name that its certificate must have.
class Upstream {
  constructor(name, target, options, texts) {
    const { path, host } = target,
      tls = options['upstream-tls'],
      baseUrl = path ? 'http://localhost' : `${tls ? 'https' : 'http'}://${name}`;
    Object.assign(this, { name, target, downUntil: 0 });
    const secure = tls ? { ...texts } : {};
    if (tls && !net.isIP(host)) secure.servername = host;
    const node = path ? { createConnection: () => net.connect(path) } : secure;
    // A connection that is silent might be dead. latvoxd answers pings of any rate.
    const pings = { pingIntervalMs: 10_000, pingTimeoutMs: 10_000, idleConnectionTimeoutMs: 60_000 };
    this.connections = Array.from({ length: Math.ceil(options['max-calls'] / STREAMS) }, () => {
      const sessionManager = new Http2SessionManager(baseUrl, pings, node);
      return { calls: 0, sessionManager, transport: createGrpcTransport({ baseUrl, sessionManager }) };
    });
  }

  // Returns the connection that has the fewest calls, and a function that ends the call on it.
  take() {
    const least = this.connections.reduce((a, b) => (b.calls < a.calls ? b : a));
    ++least.calls;
    return { transport: least.transport, leave: () => --least.calls };
  }

  close() {
    for (const { sessionManager } of this.connections) sessionManager.abort();
  }
}

export class Upstreams {
  constructor(options, log, watched) {
    Object.assign(this, { options, log, servers: new Map(), turn: 0 });
    const paths = ['upstream-ca', 'upstream-cert', 'upstream-key'].map((name) => options[name]);
    watched.add({
      read: 'upstream_tls_read',
      kept: 'upstream_tls_kept',
      paths,
      use: (texts) => this.renew(paths, texts),
    });
  }

  // Later calls use connections with these texts. Calls on the old connections go on; those end when idle.
  renew([caPath, ...pairPaths], [ca, cert, key]) {
    // An empty file is an error. Without roots of its own, a connection would trust those of the system.
    if (caPath) certificateOf(caPath, ca);
    if (pairPaths[0]) checkPair(pairPaths, [cert, key]);
    this.texts = Object.fromEntries(Object.entries({ ca, cert, key }).filter(([, text]) => text));
    for (const [name, { target }] of this.servers) this.servers.set(name, this.serverOf(name, target));
    return { paths: [caPath, ...pairPaths].filter(Boolean).join() };
  }

  serverOf(name, target) {
    return new Upstream(name, target, this.options, this.texts);
  }

  // Finds the servers, and looks again now and then: a name may have several addresses, and others later.
  async start() {
    await this.resolve();
    if (!this.options.upstream.some(({ host }) => host && !net.isIP(host))) return;
    this.timer = setInterval(() => this.resolve(), RESOLVE);
    this.timer.unref();
  }

  async resolve() {
    const found = new Map();
    let complete = true;
    for (const target of this.options.upstream) {
      const { path, host, port } = target,
        addresses = path ? [] : await this.addressesOf(host);
      if (path) found.set(`unix:${path}`, target);
      complete &&= addresses !== null;
      for (const address of addresses ?? []) found.set(bracketed(address, port), target);
    }
    for (const [name, target] of found)
      if (!this.servers.has(name)) this.servers.set(name, this.serverOf(name, target));
    // The calls of a server that has left its name go on; its connection ends when they have.
    for (const name of this.servers.keys()) if (complete && !found.has(name)) this.servers.delete(name);
  }

  // Returns null if nobody knows.
  async addressesOf(host) {
    try {
      return (await dns.lookup(host, { all: true })).map(({ address }) => address);
    } catch (error) {
      this.log.write('warning', 'upstream_unresolved', { host, error: error.code });
      return null;
    }
  }

  // Returns the server for a mesh, or the next one; null if there is none. All calls about a mesh go to one server,
  // because the pieces of an upload must come together.
  choose(mesh) {
    const all = [...this.servers.values()],
      now = Date.now(),
      up = all.filter(({ downUntil }) => downUntil <= now);
    const candidates = up.length > 0 ? up : all;
    if (candidates.length === 0) return null;
    if (!(mesh?.length > 0)) return candidates[this.turn++ % candidates.length];
    const weight = ({ name }) => createHash('sha256').update(mesh).update(name).digest('hex');
    return candidates.reduce((a, b) => (weight(b) > weight(a) ? b : a));
  }

  // Says that a server could not be reached.
  avoid(upstream, why) {
    if (upstream.downUntil <= Date.now())
      this.log.write('warning', 'upstream_unreached', { address: upstream.name, error: why });
    upstream.downUntil = Date.now() + PAUSE;
  }

  // Returns the number of servers that get no calls, because they could not be reached.
  down() {
    const now = Date.now();
    return [...this.servers.values()].filter(({ downUntil }) => downUntil > now).length;
  }

  close() {
    clearInterval(this.timer);
    for (const upstream of this.servers.values()) upstream.close();
  }
}
