// Errors of the gateway's own, with the details that latvoxd's errors have, and answers that carry them.
import { create, createFileRegistry, fromBinary, toBinary, toJson } from '@bufbuild/protobuf';
import { FileDescriptorSetSchema } from '@bufbuild/protobuf/wkt';
import { Code, ConnectError } from '@connectrpc/connect';
import { encodeEnvelope } from '@connectrpc/connect/protocol';
import { codeToHttpStatus, endStreamFlag, endStreamToJson, errorToJson } from '@connectrpc/connect/protocol-connect';
import { setTrailerStatus } from '@connectrpc/connect/protocol-grpc';

// Metadata of latvoxd's answers that callers get.
export const PASSED_DOWN = ['traceparent', 'grpc-retry-pushback-ms'];

// The reasons of all errors of the gateway's own.
export const REASONS = [
  'CLIENT_STALLED',
  'LIMIT_EXCEEDED',
  'MEMORY_IN_USE',
  'SERVER_STOPPING',
  'TOO_MANY_JOBS',
  'UNAVAILABLE',
  'UNIMPLEMENTED',
];

// The messages of protocol.binpb.
export class Protocol {
  constructor(bytes) {
    this.registry = createFileRegistry(fromBinary(FileDescriptorSetSchema, bytes));
    this.voxelizer = this.registry.getService('latvox.v1.Voxelizer');
    this.health = this.registry.getService('grpc.health.v1.Health');
  }

  // Returns a detail of an error, readable in JSON.
  detail(type, fields) {
    const schema = this.registry.getMessage(type),
      message = create(schema, fields);
    return this.readable({ type, value: toBinary(schema, message) });
  }

  readable({ type, value }) {
    const schema = this.registry.getMessage(type);
    return { type, value, ...(schema && { debug: toJson(schema, fromBinary(schema, value)) }) };
  }

  // Returns an error with an ErrorInfo, whose `reason` is one of REASONS. With `seconds`, another try after them may
  // help.
  error(code, reason, message, metadata = {}, seconds = null) {
    const error = new ConnectError(message, code);
    error.details.push(this.detail('google.rpc.ErrorInfo', { domain: 'latvox', reason, metadata }));
    if (seconds !== null)
      error.details.push(this.detail('google.rpc.RetryInfo', { retryDelay: { seconds: BigInt(seconds) } }));
    return Object.assign(error, { reason });
  }

  limit(field, value, limit, name) {
    const message = `${field}: ${value} bytes exceed ${limit}, the gateway's ${name}`;
    return this.error(Code.ResourceExhausted, 'LIMIT_EXCEEDED', message, {
      field,
      value: String(value),
      limit: String(limit),
    });
  }

  // Returns the error for a server that cannot be reached, or whose connection broke.
  away() {
    return this.error(
      Code.Unavailable,
      'UNAVAILABLE',
      'upstream: there is no connection to latvoxd',
      { field: 'upstream' },
      1,
    );
  }

  // Returns an error of latvoxd as callers get it.
  passed(error) {
    const kept = PASSED_DOWN.filter((name) => error.metadata.has(name)).map((name) => [name, error.metadata.get(name)]);
    const passed = new ConnectError(error.rawMessage, error.code, kept);
    passed.details = error.details.map((detail) => (detail.type ? this.readable(detail) : detail));
    return passed;
  }
}

// Returns why the connection to latvoxd failed, such as ECONNREFUSED; null if it did not. `left`: the caller has left,
// or its deadline is over. Node closes the streams of a connection that breaks as if they were canceled.
export function disconnected(error, left) {
  if (error.metadata.has('grpc-status') || error.code === Code.DeadlineExceeded || left) return null;
  for (let cause = error.cause; cause; cause = cause.cause) if (typeof cause.code === 'string') return cause.code;
  return [Code.Unavailable, Code.Canceled].includes(error.code) ? error.rawMessage : null;
}

// Answers a request whose body is not read.
export function refuse(request, response, error) {
  const type = request.headers['content-type'] ?? '';
  if (type.startsWith('application/grpc-web')) {
    response.writeHead(200, Object.fromEntries(setTrailerStatus(new Headers({ 'content-type': type }), error)));
    response.end();
  } else if (type.startsWith('application/connect+')) {
    const end = new TextEncoder().encode(JSON.stringify(endStreamToJson(new Headers(), error)));
    response.writeHead(200, { 'content-type': type });
    response.end(encodeEnvelope(endStreamFlag, end));
  } else {
    response.writeHead(codeToHttpStatus(error.code), { 'content-type': 'application/json' });
    response.end(JSON.stringify(errorToJson(error)));
  }
}
