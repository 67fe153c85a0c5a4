// The calls in progress: how many there may be, how large they may be, and a line of the log for each.
import { Code } from '@connectrpc/connect';

// Returns the code's name in gRPC.
export const nameOf = (code) =>
  Code[code]
    .replace(/(?<=[a-z])(?=[A-Z])/g, '_')
    .toUpperCase()
    .replace('CANCELED', 'CANCELLED');

function peerOf({ remoteAddress, remotePort, remoteFamily }) {
  return remoteAddress
    ? `${remoteFamily === 'IPv6' ? `ipv6:[${remoteAddress}]` : `ipv4:${remoteAddress}`}:${remotePort}`
    : undefined;
}

function protocolOf(type) {
  const [, kind] = type.match(/^application\/(grpc-web|connect|grpc)?/) ?? [];
  return `${kind ?? 'connect'}${/json/.test(type) ? '+json' : ''}`;
}

class Call {
  constructor(calls, request, response) {
    // `bytes`: the room that its body has reserved.
    Object.assign(this, { calls, response, bytes: 0, bytesIn: 0, bytesOut: 0, error: null, start: performance.now() });
    const type = request.headers['content-type'] ?? '',
      trace = /^00-([0-9a-f]{32})-/.exec(request.headers.traceparent ?? '');
    this.origin = {
      method: request.url.split(/[/?]/)[2],
      protocol: protocolOf(type),
      peer: peerOf(request.socket),
      trace_id: trace?.[1],
    };
    response.once('close', () => this.close());
  }

  failed(error) {
    this.error ??= error;
  }

  // latvoxd is done. A caller that does not read the rest is dropped. One that left before is no longer here.
  ended() {
    if (this.isClosed) return;
    const limit = this.calls.options['stall-timeout'];
    this.timer ??= setTimeout(() => {
      const message = `stall-timeout: the caller has not read the end of its answer within ${limit} s`;
      this.failed(this.calls.protocol.error(Code.Unavailable, 'CLIENT_STALLED', message, { limit: `${limit}s` }, 1));
      (this.response.stream ?? this.response).destroy();
    }, 1000 * limit);
  }

  close() {
    this.isClosed = true;
    clearTimeout(this.timer);
    this.calls.leave(this);
    const { error, response } = this,
      milliseconds = performance.now() - this.start;
    const code = error
      ? nameOf(error.code)
      : !response.writableFinished && response.stream?.rstCode !== 0
        ? 'CANCELLED'
        : this.codeOfStatus();
    const facts = {
      ...this.origin,
      code,
      bytes_in: this.bytesIn,
      bytes_out: this.bytesOut,
      total_ms: milliseconds.toFixed(3),
    };
    const { bytesIn, bytesOut } = this;
    this.calls.metrics?.count({
      method: this.origin.method,
      code,
      reason: error?.reason,
      bytesIn,
      bytesOut,
      seconds: milliseconds / 1000,
    });
    const level =
      code === 'INTERNAL' ? 'error' : /GetLimits|Check/.test(this.origin.method) && code === 'OK' ? 'debug' : 'info';
    this.calls.log.write(level, 'request', { ...facts, error: error?.rawMessage });
  }

  // Connect's own errors, such as of JSON that cannot be read, have a status of HTTP alone.
  codeOfStatus() {
    const { statusCode } = this.response;
    return statusCode === 200 ? 'OK' : statusCode === 400 ? 'INVALID_ARGUMENT' : `HTTP_${statusCode}`;
  }
}

export class Calls {
  constructor({ options, protocol, log, metrics }) {
    Object.assign(this, { options, protocol, log, metrics, running: new Set(), bytes: 0, stopping: false });
  }

  // Returns { call } or { call, error }. A body of unknown length counts as the largest.
  enter(request, response) {
    const { 'max-calls': most, 'max-body': mostBytes, 'max-bodies': room } = this.options,
      { protocol } = this;
    const length = request.headers['content-length'],
      bytes = length === undefined ? mostBytes : Number(length);
    const call = new Call(this, request, response);
    const refused = () => {
      if (this.stopping) return protocol.error(Code.Unavailable, 'SERVER_STOPPING', 'the gateway stops', {}, 1);
      if (bytes > mostBytes) return protocol.limit('body', bytes, mostBytes, '--max-body');
      if (this.running.size >= most) {
        return protocol.error(
          Code.ResourceExhausted,
          'TOO_MANY_JOBS',
          `calls: ${this.running.size + 1} exceed ${most}, the gateway's --max-calls`,
          { field: 'calls', value: String(this.running.size + 1), limit: String(most) },
          1,
        );
      }
      if (this.bytes + bytes > room) {
        return protocol.error(
          Code.ResourceExhausted,
          'MEMORY_IN_USE',
          `bodies: ${this.bytes + bytes} bytes exceed ${room}, the gateway's --max-bodies`,
          { field: 'bodies', value: String(this.bytes + bytes), limit: String(room) },
          1,
        );
      }
      return null;
    };
    const error = refused();
    if (error) {
      call.failed(error);
    } else {
      call.bytes = bytes;
      this.bytes += bytes;
      this.running.add(call);
    }
    return { call, error };
  }

  leave(call) {
    this.bytes -= call.bytes;
    this.running.delete(call);
    if (this.running.size === 0) this.idle?.();
  }

  // Resolves when no call is running, or after some seconds.
  drain(seconds) {
    this.stopping = true;
    return new Promise((resolve) => {
      this.idle = resolve;
      if (this.running.size === 0) resolve();
      setTimeout(resolve, 1000 * seconds);
    });
  }
}
