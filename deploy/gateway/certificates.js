// Certificates and keys in PEM form, checked before a connection needs them.
import { createPrivateKey, X509Certificate } from 'node:crypto';
import { createSecureContext } from 'node:tls';

// Returns the first certificate of the file. Throws an Error that names the file, if one of them cannot be read.
export function certificateOf(path, text) {
  try {
    createSecureContext({ cert: text }); // X509Certificate reads only the first one
    return new X509Certificate(text);
  } catch {
    throw new Error(`${path}: it holds no certificate in PEM form, or one that cannot be read`);
  }
}

// Returns the end of the certificate's validity. Throws an Error that names the file, unless the key is that of the
// certificate.
export function checkPair([path, keyPath], [text, keyText]) {
  const certificate = certificateOf(path, text);
  let key;
  try {
    key = createPrivateKey(keyText);
  } catch {
    throw new Error(`${keyPath}: it holds no private key in PEM form without a passphrase`);
  }
  if (!certificate.checkPrivateKey(key))
    throw new Error(`${keyPath}: the key is not that of the certificate in ${path}`);
  return new Date(certificate.validTo);
}
