// Calls of latvox.v1.Voxelizer in Connect-JSON.
const PATH = 'latvox.v1.Voxelizer/';
const PIECE = 2 << 20; // bytes of a mesh in one message

// An error of the service: its code, message, and the reason of its ErrorInfo.
export class ServiceError extends Error {
  constructor({ code, message, details = [] }) {
    super(message ?? code);
    this.code = code;
    const info = details.find(({ type }) => type === 'google.rpc.ErrorInfo')?.debug;
    this.reason = info?.reason;
    this.limit = info?.metadata?.limit;
  }
}

export function base64Of(bytes) {
  let text = '';
  for (let at = 0; at < bytes.length; at += 32768) text += String.fromCharCode(...bytes.subarray(at, at + 32768));
  return btoa(text);
}

export function bytesOf(base64 = '') {
  const text = atob(base64),
    bytes = new Uint8Array(text.length);
  for (let n = 0; n < text.length; ++n) bytes[n] = text.charCodeAt(n);
  return bytes;
}

export class Service {
  // `token` returns a bearer token, or ''.
  constructor(token) {
    this.token = token;
  }

  async post(method, type, body, signal) {
    const token = this.token(),
      headers = { 'content-type': type, 'connect-protocol-version': '1' };
    if (token !== '') headers.authorization = `Bearer ${token}`;
    try {
      return await fetch(PATH + method, { method: 'POST', headers, body, signal });
    } catch (error) {
      if (signal.aborted) throw error;
      throw new ServiceError({ code: 'unavailable', message: 'The gateway cannot be reached.' });
    }
  }

  async unary(method, request, signal) {
    const answer = await this.post(method, 'application/json', JSON.stringify(request), signal);
    const told = await answer.json().catch(() => ({ code: 'unknown', message: `HTTP status ${answer.status}` }));
    if (!answer.ok) throw new ServiceError(told);
    return told;
  }

  // Yields the messages of a stream. Each has five bytes before it: flags and length.
  async *stream(method, request, signal) {
    const text = new TextEncoder().encode(JSON.stringify(request)),
      body = new Uint8Array(5 + text.length);
    new DataView(body.buffer).setUint32(1, text.length);
    body.set(text, 5);
    const answer = await this.post(method, 'application/connect+json', body, signal);
    if (!answer.ok) throw new ServiceError({ code: 'unknown', message: `HTTP status ${answer.status}` });
    for await (const { flags, message } of envelopes(answer.body.getReader())) {
      if ((flags & 2) === 0) yield message;
      else if (message.error) throw new ServiceError(message.error);
      else return;
    }
    throw new ServiceError({ code: 'unavailable', message: 'The answer ended early.' });
  }

  // Stores a mesh, from where an earlier upload ended.
  async upload(spec, bytes, signal, progress) {
    let offset = 0,
      piece = new Uint8Array();
    for (;;) {
      const answer = await this.unary('UploadMesh', { spec, offset, meshPiece: base64Of(piece) }, signal).catch(
        (error) => {
          if (error.reason !== 'WRONG_OFFSET') throw error;
          return { nextOffset: error.limit };
        },
      );
      if (answer.stored) return;
      offset = Number(answer.nextOffset ?? 0);
      piece = bytes.subarray(offset, offset + PIECE);
      progress(offset / bytes.length);
    }
  }
}

async function* envelopes(reader) {
  let have = new Uint8Array(),
    end = 0;
  const text = new TextDecoder();
  for (;;) {
    const length = end < 5 ? 0 : new DataView(have.buffer, have.byteOffset).getUint32(1);
    if (end >= 5 && end >= 5 + length) {
      yield { flags: have[0], message: JSON.parse(text.decode(have.subarray(5, 5 + length))) };
      have = have.subarray(5 + length);
      end -= 5 + length;
      continue;
    }
    const { done, value } = await reader.read();
    if (done) return;
    if (end + value.length > have.length) {
      const longer = new Uint8Array(Math.max(2 * end, end + value.length, length + 5));
      longer.set(have.subarray(0, end));
      have = longer;
    }
    have.set(value, end);
    end += value.length;
  }
}
