export class Pages {
  serve() { return false; }
}
