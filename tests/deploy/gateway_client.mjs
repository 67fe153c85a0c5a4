// A caller of the gateway with npm's Connect packages. Takes calls as JSON, and prints what came of each as JSON:
//   url, set: file of the protocol, calls: a list of
//   { protocol: connect | connect+json | grpc-web, method, request, headers, timeout }
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

// These packages are the gateway's.
const need = createRequire(new URL('../../deploy/gateway/package.json', import.meta.url));
const { createFileRegistry, fromBinary, fromJson, toJson } = need('@bufbuild/protobuf');
const { FileDescriptorSetSchema } = need('@bufbuild/protobuf/wkt');
const { Code, ConnectError } = need('@connectrpc/connect');
const { createConnectTransport, createGrpcWebTransport } = need('@connectrpc/connect-node');

const { url, set, calls } = JSON.parse(readFileSync(0, 'utf8'));
const registry = createFileRegistry(fromBinary(FileDescriptorSetSchema, readFileSync(set)));
const methods = registry.getService('latvox.v1.Voxelizer').methods;

async function* single(message) {
  yield message;
}

function readable({ type, value }) {
  const schema = registry.getMessage(type);
  return { type, ...toJson(schema, fromBinary(schema, value)) };
}

async function tell({ protocol, method: name, request, headers, timeout }) {
  const method = methods.find((each) => each.name === name),
    message = fromJson(method.input, request);
  const options = { baseUrl: url, httpVersion: '1.1', useBinaryFormat: protocol !== 'connect+json' };
  const transport = protocol === 'grpc-web' ? createGrpcWebTransport(options) : createConnectTransport(options);
  const messages = [];
  try {
    const unary = method.methodKind === 'unary';
    const answer = unary
      ? await transport.unary(method, undefined, timeout, headers, message)
      : await transport.stream(method, undefined, timeout, headers, single(message));
    if (unary) messages.push(toJson(method.output, answer.message));
    else for await (const each of answer.message) messages.push(toJson(method.output, each));
    return { messages, header: Object.fromEntries(answer.header) };
  } catch (reason) {
    const error = ConnectError.from(reason);
    return { messages, code: Code[error.code], message: error.rawMessage, details: error.details.map(readable) };
  }
}

const told = [];
for (const call of calls) told.push(await tell(call));
process.stdout.write(JSON.stringify(told));
