// Connections to latvoxd, and the choice among several.
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import net from 'node:net';
import { createGrpcTransport, Http2SessionManager } from '@connectrpc/connect-node';

const STREAMS = 200; // calls on a connection; latvoxd takes 256
const PAUSE = 1000; // milliseconds without calls for a server that could not be reached

class Upstream {
  constructor({ host, port, path }, options) {
    const tls = options['upstream-tls'];
    this.name = path ? `unix:${path}` : `${host.includes(':') ? `[${host}]` : host}:${port}`;
    this.downUntil = 0;
    const read = (name) => (options[name] ? readFileSync(options[name]) : undefined);
    const secure = tls ? { ca: read('upstream-ca'), cert: read('upstream-cert'), key: read('upstream-key') } : {};
    const node = path ? { createConnection: () => net.connect(path) } : secure;
    const baseUrl = path ? 'http://localhost' : `${tls ? 'https' : 'http'}://${this.name}`;
    // A connection that is silent might be dead. latvoxd answers pings of any rate.
    const made = () => new Http2SessionManager(baseUrl, { pingIntervalMs: 10_000, pingTimeoutMs: 10_000, idleConnectionTimeoutMs: 60_000 }, node);
    this.transports = Array.from({ length: Math.ceil(options['max-calls'] / STREAMS) }, () => {
      const sessionManager = made();
      return { calls: 0, sessionManager, transport: createGrpcTransport({ baseUrl, sessionManager }) };
    });
  }

  // Returns the connection that has the fewest calls, and a function that ends the call on it.
  take() {
    const least = this.transports.reduce((a, b) => (b.calls < a.calls ? b : a));
    ++least.calls;
    return { transport: least.transport, leave: () => --least.calls };
  }

  close() {
    for (const { sessionManager } of this.transports) sessionManager.abort();
  }
}

export class Upstreams {
  constructor(options, log) {
    this.log = log;
    this.all = options.upstream.map((address) => new Upstream(address, options));
    this.turn = 0;
  }

  // Returns the server for a mesh, or the next one. All calls about a mesh go to one server, because the pieces of an
  // upload must come together.
  choose(mesh) {
    const now = Date.now(), up = this.all.filter(({ downUntil }) => downUntil <= now), candidates = up.length > 0 ? up : this.all;
    if (!(mesh?.length > 0)) return candidates[this.turn++ % candidates.length];
    const weight = ({ name }) => createHash('sha256').update(mesh).update(name).digest('hex');
    return candidates.reduce((a, b) => (weight(b) > weight(a) ? b : a));
  }

  // Says that a server could not be reached.
  avoid(upstream, why) {
    if (upstream.downUntil <= Date.now()) this.log.write('warning', 'upstream_unreached', { address: upstream.name, error: why });
    upstream.downUntil = Date.now() + PAUSE;
  }

  close() {
    for (const upstream of this.all) upstream.close();
  }
}
