// The HTTP server: calls, CORS, health, and the page.
import { Code, createContextValues, createConnectRouter } from '@connectrpc/connect';
import { universalRequestFromNodeRequest, universalResponseToNodeResponse } from '@connectrpc/connect-node';
import { setMaxListeners } from 'node:events';
import http from 'node:http';
import http2 from 'node:http2';
import { Calls } from './calls.js';
import { checkPair } from './certificates.js';
import { CALL, Forward, PASSED_UP } from './forward.js';
import { PASSED_DOWN, refuse } from './refusals.js';

const ALLOWED = [
  'content-type',
  'connect-protocol-version',
  'connect-timeout-ms',
  'grpc-timeout',
  'x-grpc-web',
  'x-user-agent',
  ...PASSED_UP,
];
const EXPOSED = ['grpc-status', 'grpc-message', 'grpc-status-details-bin', ...PASSED_DOWN];

export class Gateway {
  constructor({ options, protocol, upstreams, log, pages, metrics, watched }) {
    Object.assign(this, { options, protocol, upstreams, log, pages, metrics, watched });
    this.calls = new Calls({ options, protocol, log, metrics });
    this.ending = new AbortController();
    const most = 2 * options['max-calls'] + 10; // each call listens
    setMaxListeners(most, this.ending.signal);
    setMaxListeners(most); // of all others: calls also listen to a connection to latvoxd that is not there yet
    // latvoxd takes no compressed messages either, because meshes and bricks are compressed already.
    const router = createConnectRouter({
      grpc: false,
      acceptCompression: [],
      readMaxBytes: options['max-body'],
      shutdownSignal: this.ending.signal,
      jsonOptions: { registry: protocol.registry, ignoreUnknownFields: false },
    });
    new Forward(protocol, upstreams).routes(router);
    this.handlers = new Map(router.handlers.map((handler) => [handler.requestPath, handler]));
    const handle = (request, response) => this.handle(request, response);
    this.server = options['tls-cert']
      ? this.secureServer(handle)
      : http.createServer({ headersTimeout: 10_000 }, handle);
    this.server.maxConnections = options['max-connections'];
    metrics?.observe(this);
  }

  // Each new connection gets the certificate that was read last; those before go on.
  secureServer(handle) {
    const server = http2.createSecureServer({ allowHTTP1: true, settings: { maxConcurrentStreams: 100 } }, handle),
      paths = [this.options['tls-cert'], this.options['tls-key']];
    const use = ([cert, key]) => {
      const expires = checkPair(paths, [cert, key]);
      server.setSecureContext({ cert, key });
      this.expires = expires;
      return { path: paths[0], expires: expires.toISOString() };
    };
    this.watched.add({ read: 'tls_certificate_read', kept: 'tls_certificate_kept', paths, use });
    return server;
  }

  async listen() {
    await this.upstreams.start();
    const { host, port } = this.options.listen;
    return new Promise((resolve, reject) => {
      this.server.once('error', reject);
      this.server.listen(port, host, () => resolve(this.server.address()));
    });
  }

  handle(request, response) {
    const path = request.url.split('?')[0],
      handler = this.handlers.get(path);
    response.setHeader('x-content-type-options', 'nosniff');
    if (this.calls.stopping && request.httpVersionMajor === 1) response.setHeader('connection', 'close');
    if (handler) return this.cors(request, response) || this.call(handler, request, response);
    if (!['GET', 'HEAD'].includes(request.method)) return this.say(response, 404, `there is no ${path}`);
    if (path === '/healthz')
      return this.say(response, this.calls.stopping ? 503 : 200, this.calls.stopping ? 'stopping' : 'serving');
    if (path === '/readyz') return this.ready(response);
    if (!this.pages.serve(path, request, response)) this.say(response, 404, `there is no ${path}`);
  }

  say(response, status, text) {
    response.writeHead(status, { 'content-type': 'text/plain; charset=utf-8', 'cache-control': 'no-store' });
    response.end(`${text}\n`);
  }

  // Answers a preflight, and returns true; or says in the answer who may read it.
  cors(request, response) {
    const { origin } = request.headers,
      allowed = this.options['cors-origin'],
      may = allowed.includes('*') || allowed.includes(origin);
    if (allowed.length > 0) response.setHeader('vary', 'origin');
    if (origin !== undefined && may) {
      response.setHeader('access-control-allow-origin', allowed.includes('*') ? '*' : origin);
      response.setHeader('access-control-expose-headers', EXPOSED.join());
    }
    if (request.method !== 'OPTIONS') return false;
    if (may) {
      response.setHeader('access-control-allow-methods', 'POST');
      response.setHeader('access-control-allow-headers', ALLOWED.join());
      response.setHeader('access-control-max-age', '600'); // seconds in which a removed origin may send calls
    }
    response.writeHead(may ? 204 : 403).end();
    return true;
  }

  async call(handler, request, response) {
    const { call, error } = this.calls.enter(request, response),
      refusal = error ?? this.upwards(handler.method);
    if (refusal) return (call.failed(refusal), refuse(request, response, refusal));
    try {
      const given = universalRequestFromNodeRequest(
        request,
        response,
        undefined,
        createContextValues().set(CALL, call),
      );
      const answer = await handler({ ...given, body: this.counted(request, call) });
      await universalResponseToNodeResponse(
        { ...answer, body: answer.body && this.measured(answer.body, call) },
        response,
      );
    } catch (reason) {
      this.log.write('debug', 'broken', { method: handler.method.name, error: reason.message });
      response.destroy?.();
    }
  }

  // Returns an error for a method that streams upwards, which browsers cannot.
  upwards({ name, methodKind }) {
    if (['unary', 'server_streaming'].includes(methodKind)) return null;
    const instead = 'call UploadMesh and VoxelizeStored, or VoxelizeSmall';
    const message = `${name} streams upwards, which the gateway does not pass on; ${instead}`;
    return this.protocol.error(Code.Unimplemented, 'UNIMPLEMENTED', message, { field: name });
  }

  // A caller that sends too much can still read the error, because the rest is read and dropped.
  async *counted(request, call) {
    const most = this.options['max-body'];
    for await (const bytes of request.iterator({ destroyOnReturn: false })) {
      call.bytesIn += bytes.length;
      if (call.bytesIn > most) {
        setImmediate(() => request.resume());
        const error = this.protocol.limit('body', call.bytesIn, most, '--max-body');
        call.failed(error);
        throw error;
      }
      yield bytes;
    }
  }

  async *measured(body, call) {
    for await (const bytes of body) {
      call.bytesOut += bytes.length;
      yield bytes;
    }
  }

  // Asks a server for its health.
  async ready(response) {
    const upstream = this.upstreams.choose(),
      check = this.protocol.health.method.check;
    if (this.calls.stopping) return this.say(response, 503, 'stopping');
    if (upstream === null) return this.say(response, 503, 'latvoxd cannot be reached');
    const { transport, leave } = upstream.take();
    try {
      const { message } = await transport.unary(check, undefined, 2000, undefined, {});
      this.say(response, message.status === 1 ? 200 : 503, message.status === 1 ? 'serving' : 'latvoxd does not serve');
    } catch {
      this.say(response, 503, 'latvoxd cannot be reached');
    } finally {
      leave();
    }
  }

  // Lets running calls end.
  async stop() {
    this.server.close();
    this.server.closeIdleConnections?.();
    await this.calls.drain(this.options.grace);
    const left = this.calls.running.size;
    this.ending.abort(this.protocol.error(Code.Unavailable, 'SERVER_STOPPING', 'the gateway stops', {}, 1));
    if (left > 0) await new Promise((resolve) => setTimeout(resolve, 200));
    this.server.closeAllConnections?.();
    this.upstreams.close();
    this.metrics?.close();
    return left;
  }
}
