// Passes calls on to latvoxd: their deadline, token, trace and end, and latvoxd's messages and errors.
import { Code, ConnectError, createContextKey } from '@connectrpc/connect';
import { disconnected, PASSED_DOWN } from './refusals.js';

// Metadata of calls that latvoxd gets.
export const PASSED_UP = ['authorization', 'traceparent', 'tracestate'];

// The gateway's record of a call; see calls.js.
export const CALL = createContextKey(null, { description: 'call' });

function copy(names, from, to) {
  for (const name of names) if (from.has(name)) to.set(name, from.get(name));
  return to;
}

async function* single(message) {
  yield message;
}

export class Forward {
  constructor(protocol, upstreams) {
    Object.assign(this, { protocol, upstreams });
  }

  // Registers all methods with a router.
  routes(router) {
    for (const service of [this.protocol.voxelizer, this.protocol.health]) {
      router.service(
        service,
        Object.fromEntries(service.methods.map((method) => [method.localName, this.handlerOf(method)])),
      );
    }
  }

  handlerOf(method) {
    if (method.methodKind === 'unary') return (request, context) => this.unary(method, request, context);
    if (method.methodKind === 'server_streaming') return (request, context) => this.stream(method, request, context);
    return () => {
      throw new ConnectError('gateway.js refuses it', Code.Unimplemented);
    };
  }

  // Returns what both kinds of calls need. `failed` returns the error for the caller.
  begin(request, context) {
    const call = context.values.get(CALL),
      upstream = this.upstreams.choose(request.spec?.meshSha256);
    if (upstream === null) {
      call.failed(this.protocol.away());
      throw this.protocol.away();
    }
    const { transport, leave } = upstream.take(),
      header = copy(PASSED_UP, context.requestHeader, new Headers());
    const failed = (reason) => {
      const given = ConnectError.from(reason),
        why = disconnected(given, context.signal.aborted);
      if (why !== null) this.upstreams.avoid(upstream, why);
      const error = why === null ? this.protocol.passed(given) : this.protocol.away();
      call.failed(error);
      return error;
    };
    return { transport, leave, call, header, failed };
  }

  async unary(method, request, context) {
    const { transport, leave, call, header, failed } = this.begin(request, context);
    try {
      const answer = await transport.unary(method, context.signal, context.timeoutMs(), header, request);
      copy(PASSED_DOWN, answer.header, context.responseHeader);
      return answer.message;
    } catch (reason) {
      throw failed(reason);
    } finally {
      leave();
      call.ended();
    }
  }

  // Takes a message from latvoxd only when the caller has taken the one before.
  async *stream(method, request, context) {
    const { transport, leave, call, header, failed } = this.begin(request, context);
    const end = new AbortController(),
      stop = () => end.abort(context.signal.reason);
    context.signal.addEventListener('abort', stop);
    try {
      if (context.signal.aborted) stop();
      const answer = await transport.stream(method, end.signal, context.timeoutMs(), header, single(request));
      copy(PASSED_DOWN, answer.header, context.responseHeader);
      yield* answer.message;
    } catch (reason) {
      throw failed(reason);
    } finally {
      context.signal.removeEventListener('abort', stop);
      end.abort(new ConnectError('the caller has left', Code.Canceled));
      leave();
      call.ended();
    }
  }
}
