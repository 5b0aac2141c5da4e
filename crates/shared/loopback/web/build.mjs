// Builds the pages of all stages: crates/stages/*/web/{*.ts, *.css, *.html} → web/built/, which the binaries embed.
//
//   node build.mjs            build
//   node build.mjs --check    build elsewhere, and fail if what is there differs
import { build } from "esbuild";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, relative } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const stages = join(here, "../../../stages");

/** Script and style are bundled, the rest of what stands beside them is copied. */
async function page(folder, out) {
  const names = readdirSync(folder).sort();
  const entryPoints = names.filter((name) => /\.(ts|css)$/.test(name)).map((name) => join(folder, name));
  await build({
    entryPoints,
    outdir: out,
    absWorkingDir: here,
    bundle: true,
    minify: true,
    format: "esm",
    target: "es2022",
    legalComments: "eof",
    nodePaths: [join(here, "node_modules")],
    alias: { pages: join(here, "src") },
    loader: { ".glsl": "text" },
    logLevel: "warning",
  });
  for (const name of names.filter((name) => name.endsWith(".html"))) {
    writeFileSync(join(out, name), readFileSync(join(folder, name)));
  }
}

/** Names of files that are not the same in two folders. */
function differing(one, other) {
  const names = [one, other].flatMap((folder) => (existsSync(folder) ? readdirSync(folder) : []));
  const bytes = (folder, name) => (existsSync(join(folder, name)) ? readFileSync(join(folder, name)) : Buffer.alloc(0));
  return [...new Set(names)].filter((name) => !bytes(one, name).equals(bytes(other, name)));
}

const check = process.argv.includes("--check");
let stale = 0;
for (const stage of readdirSync(stages).sort()) {
  const folder = join(stages, stage, "web");
  if (!existsSync(folder)) continue;
  const built = join(folder, "built");
  const out = check ? mkdtempSync(join(tmpdir(), "pages-")) : built;
  if (!check) rmSync(built, { recursive: true, force: true });
  mkdirSync(out, { recursive: true });
  await page(folder, out);
  for (const name of check ? differing(built, out) : []) {
    console.error(`${relative(join(here, "../../../.."), join(built, name))}: is not what its sources make; run: just web`);
    stale += 1;
  }
  if (check) rmSync(out, { recursive: true });
}
process.exitCode = stale ? 1 : 0;
