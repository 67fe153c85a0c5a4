// The figures that Prometheus reads: calls, refusals, bytes, limits, and the process. Names and labels are like those of
// latvoxd.
import { Code } from '@connectrpc/connect';
import http from 'node:http';
import { collectDefaultMetrics, Counter, Gauge, Histogram, Registry } from 'prom-client';
import { nameOf } from './calls.js';
import { REASONS } from './refusals.js';

const CODES = ['OK', ...Object.values(Code).filter(Number.isInteger).map(nameOf)];
const BUCKETS = [0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 10, 30, 60, 300];

export class Metrics {
  constructor(protocol, log) {
    this.log = log;
    this.registry = new Registry();
    collectDefaultMetrics({ register: this.registry });
    this.requests = this.add(Counter, 'requests_total', 'Calls that are over, by method and status code.', [
      'method',
      'code',
    ]);
    const refused = 'Calls that the gateway itself refused or gave up, by ErrorInfo.reason.';
    this.rejections = this.add(Counter, 'rejections_total', refused, ['reason']);
    this.received = this.add(Counter, 'received_bytes_total', 'Bytes of requests, by method.', ['method']);
    this.sent = this.add(Counter, 'sent_bytes_total', 'Bytes of answers, by method.', ['method']);
    const ended = 'Time of calls that ended OK, by method.';
    this.durations = this.add(Histogram, 'request_duration_seconds', ended, ['method'], { buckets: BUCKETS });
    this.startAtZero([protocol.voxelizer, protocol.health].flatMap(({ methods }) => methods.map(({ name }) => name)));
  }

  add(Kind, name, help, labelNames = [], more = {}) {
    return new Kind({ name: `latvox_gateway_${name}`, help, labelNames, registers: [this.registry], ...more });
  }

  // Adds a value that `read` gives whenever Prometheus asks.
  reading(name, help, read) {
    const collect = async function () {
      this.set(await read());
    };
    this.add(Gauge, name, help, [], { collect });
  }

  // rate() does not see the first event of a counter that appears with it.
  startAtZero(methods) {
    for (const method of methods) {
      for (const code of CODES) this.requests.inc({ method, code }, 0);
      this.received.inc({ method }, 0);
      this.sent.inc({ method }, 0);
      this.durations.zero({ method });
    }
    for (const reason of REASONS) this.rejections.inc({ reason }, 0);
  }

  // Counts a call that is over. `reason` is undefined unless the gateway refused it.
  count({ method, code, reason, bytesIn, bytesOut, seconds }) {
    this.requests.inc({ method, code });
    if (reason) this.rejections.inc({ reason });
    this.received.inc({ method }, bytesIn);
    this.sent.inc({ method }, bytesOut);
    if (code === 'OK') this.durations.observe({ method }, seconds);
  }

  // Adds the values of a gateway.
  observe(gateway) {
    const { options, calls, upstreams, server } = gateway;
    const connections = () =>
      new Promise((resolve, reject) =>
        server.getConnections((error, count) => (error ? reject(error) : resolve(count))),
      );
    this.reading('calls_running', 'Calls in progress.', () => calls.running.size);
    this.reading('calls_max', '--max-calls.', () => options['max-calls']);
    this.reading('body_bytes', 'Bytes that calls in progress have reserved for their bodies.', () => calls.bytes);
    this.reading('body_limit_bytes', '--max-bodies.', () => options['max-bodies']);
    const expiry = ['tls_certificate_expiry_timestamp_seconds', 'End of validity of the certificate of --tls-cert.'];
    if (gateway.expires) this.reading(...expiry, () => gateway.expires / 1000);
    this.reading('connections', 'Open connections of callers.', connections);
    this.reading('connections_max', '--max-connections.', () => options['max-connections']);
    this.reading('upstreams', 'Servers that the addresses of --upstream lead to.', () => upstreams.servers.size);
    this.reading('upstreams_down', 'Servers that could not be reached a second ago or less.', () => upstreams.down());
  }

  // Resolves to the address that /metrics has. By itself, Node looks for late requests only every 30 s: a few idle
  // connections would keep Prometheus out until then.
  serve({ host, port }) {
    const times = { headersTimeout: 1000, requestTimeout: 1000, connectionsCheckingInterval: 1000 };
    this.server = http.createServer(times, (request, response) => this.answer(request, response));
    this.server.maxConnections = 8;
    return new Promise((resolve, reject) => {
      this.server.once('error', ({ code }) => reject(new Error(`--metrics-listen: ${host}:${port}: ${code}`)));
      this.server.listen(port, host, () => resolve(this.server.address()));
    });
  }

  async answer(request, response) {
    const { status, type = 'text/plain', text } = await this.answerTo(request);
    response.writeHead(status, { 'content-type': type }).end(text);
  }

  // Figures that cannot be read are no reason to end calls.
  async answerTo({ method, url }) {
    if (method !== 'GET' || url !== '/metrics') return { status: 404, text: 'there is only /metrics\n' };
    try {
      return { status: 200, type: this.registry.contentType, text: await this.registry.metrics() };
    } catch ({ message }) {
      this.log.write('error', 'metrics_failed', { error: message });
      return { status: 500, text: `${message}\n` };
    }
  }

  close() {
    this.server.close();
    this.server.closeAllConnections?.();
  }
}
