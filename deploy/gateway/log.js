// The log on standard error, in the formats of latvoxd: key=value pairs, or JSON objects.
const LEVELS = ['debug', 'info', 'warning', 'error', 'off'];

// Quotes a text that would otherwise not be one value.
function quoted(value) {
  const text = String(value);
  return /^[^\s"=]+$/.test(text) ? text : JSON.stringify(text);
}

export class Log {
  constructor(level, format) {
    this.level = level;
    this.json = format === 'json';
  }

  // Writes a line. Fields without a value are left out.
  write(level, event, fields = {}) {
    if (LEVELS.indexOf(level) < LEVELS.indexOf(this.level)) return;
    const given = Object.entries(fields).filter(([, value]) => value !== undefined);
    const all = [['time', new Date().toISOString()], ['level', level], ['event', event], ...given];
    const line = this.json
      ? JSON.stringify(Object.fromEntries(all))
      : all.map(([name, value]) => `${name}=${quoted(value)}`).join(' ');
    process.stderr.write(`${line}\n`);
  }
}
