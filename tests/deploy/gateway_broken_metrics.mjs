#!/usr/bin/env node
// The gateway with a figure that cannot be read. Beside it a plain server of Node, with the gateway's limit for headers.
import http from 'node:http';
import { Metrics } from '../../deploy/gateway/metrics.js';

const { observe } = Metrics.prototype;
Metrics.prototype.observe = function (gateway) {
  observe.call(this, gateway);
  this.reading('broken', 'A figure that cannot be read.', () => {
    throw new Error('there is no figure');
  });
};

const plain = http.createServer({ headersTimeout: 1000 });
await new Promise((resolve) => plain.listen(0, '127.0.0.1', resolve));
plain.unref();
process.stderr.write(`plain ${plain.address().port}\n`);
await import('../../deploy/gateway/main.js');
