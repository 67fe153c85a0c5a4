// Files that an operator gives: configuration, certificates, keys. They are bounded like those of latvoxd, because
// their texts stay in memory.
import { readFileSync, statSync } from 'node:fs';
import { readFile, stat } from 'node:fs/promises';

const MOST_BYTES = 2 ** 20;

// A pipe without a writer would block the read.
function check(path, facts) {
  if (!facts.isFile()) throw new Error(`${path}: it is no regular file`);
  if (facts.size > MOST_BYTES) throw new Error(`${path}: it has ${facts.size} bytes, more than ${MOST_BYTES}`);
}

const explained = (path, error) => (error.code ? new Error(`${path}: it cannot be read: ${error.code}`) : error);

// Returns the text. Throws an Error that names the file.
export function readSmallFileSync(path) {
  try {
    check(path, statSync(path));
    return readFileSync(path, 'utf8');
  } catch (error) {
    throw explained(path, error);
  }
}

// Does the same while calls go on.
export async function readSmallFile(path) {
  try {
    check(path, await stat(path));
    return await readFile(path, 'utf8');
  } catch (error) {
    throw explained(path, error);
  }
}
