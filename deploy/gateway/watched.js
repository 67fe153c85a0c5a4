// Files that may change while the gateway runs. Their bytes are compared each second, because fs.watch loses the
// Secrets of Kubernetes, which are links that move.
import { readSmallFile, readSmallFileSync } from './small_file.js';

const PERIOD = 1000; // milliseconds

export class Watched {
  constructor(log) {
    Object.assign(this, { log, groups: [], looking: Promise.resolve() });
  }

  // Gives the texts of the files to `use`, now and whenever one of them has changed; null for a path that is null.
  // `use` returns fields for the event `read` of the log. An error at the start is thrown. A later one becomes the
  // event `kept`: whatever `use` had made before stays.
  add({ read, kept, paths, use }) {
    const texts = paths.map((path) => path && readSmallFileSync(path));
    use(texts);
    if (paths.some(Boolean)) this.groups.push({ read, kept, paths, use, seen: texts.map(String) });
  }

  start() {
    this.timer = setInterval(() => this.look(), PERIOD);
    this.timer.unref();
  }

  // Looks at all files, after the look that is in progress.
  look() {
    this.looking = this.looking.then(async () => {
      for (const group of this.groups) await this.lookAt(group);
    });
    return this.looking;
  }

  async lookAt(group) {
    const found = await Promise.all(group.paths.map((path) => path && readSmallFile(path).catch((error) => error)));
    const seen = found.map(String);
    if (seen.every((text, n) => text === group.seen[n])) return;
    group.seen = seen;
    try {
      const error = found.find((each) => each instanceof Error);
      if (error) throw error;
      this.log.write('info', group.read, group.use(found));
    } catch (error) {
      this.log.write('error', group.kept, { error: error.message });
    }
  }
}
