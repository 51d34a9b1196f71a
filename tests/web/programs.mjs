// The real programs, for tests of the page: a server with a separate store, `ballpiston web`, and
// the command line. BALLPISTON_BIN is the folder with ballpiston and ballpistond.
import {execFileSync, spawn} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {createInterface} from 'node:readline';

const bin = resolve(process.env.BALLPISTON_BIN ?? '../../build/release/bin');
const program = join(bin, 'ballpiston');

export class Programs {
  constructor() {
    this.folder = mkdtempSync(join(tmpdir(), 'ballpiston-page-'));
    this.environment = {
      PATH: process.env.PATH,
      HOME: this.folder,
      BALLPISTON_SERVER: `unix:${join(this.folder, 'socket')}`,
    };
    this.startServer();
  }

  get dataFolder() {
    return join(this.folder, 'data');
  }

  startServer() {
    const {BALLPISTON_SERVER: address} = this.environment;
    this.run('server start --workers 1 --listen', address, '--data-dir', this.dataFolder);
  }

  stopServer() {
    this.run('server stop --data-dir', this.dataFolder);
  }

  // The standard output of `ballpiston COMMAND WORDS`, without the last line end. The words of the
  // command are separated by blanks; the further words, such as paths, may contain blanks.
  run(command, ...words) {
    const options = {
      env: this.environment,
      encoding: 'utf8',
      stdio: ['ignore', 'pipe', 'pipe'],
      maxBuffer: 1 << 28,
    };
    return execFileSync(program, [...command.split(' '), ...words], options).trimEnd();
  }

  // Starts `ballpiston web`. Returns {address, stop()}; the address contains the token. `port` 0
  // chooses a free port.
  async web(port = 0) {
    const child = spawn(program, ['web', '--port', String(port)], {
      env: this.environment,
      stdio: ['ignore', 'pipe', 'ignore'],
    });
    const ended = new Promise((done) => child.once('exit', done));
    for await (const address of createInterface({input: child.stdout})) {
      const stop = () => {
        child.kill('SIGTERM');
        return ended;
      };
      return {address, stop};
    }
    throw new Error('ballpiston web printed no address');
  }

  remove() {
    try {
      this.stopServer();
    } finally {
      rmSync(this.folder, {recursive: true});
    }
  }
}
