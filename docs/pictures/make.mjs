// Makes the pictures of the documentation out of reports: node docs/pictures/make.mjs (after the build; needs `npm --prefix tests ci` and Chromium).
import { execFileSync } from 'node:child_process';
import { mkdirSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const root = resolve(here, '../..');
const build = resolve(root, process.env.NMC_BUILD ?? 'build');
const { chromium } = createRequire(join(root, 'tests/package.json'))('playwright-core');
const scratch = join(build, 'pictures');
mkdirSync(scratch, { recursive: true });

const run = (program, ...args) => execFileSync(join(build, program), args, { stdio: ['ignore', 'pipe', 'inherit'] });
run('make_characters', scratch);

/** The humanoid's report at a tolerance. */
function reportAt(tolerance) {
  const name = `humanoid_${tolerance.replace('%', '')}`;
  const page = join(scratch, `${name}.html`);
  run('gltf-nmc', join(scratch, 'humanoid_30hz.glb'), join(scratch, `${name}.glb`), '--tolerance', tolerance, '--quiet', '--report', page);
  return page;
}

const executablePath = process.env.NMC_CHROMIUM ?? '/usr/bin/chromium';
const browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'] });

async function open(file, width, height) {
  const page = await browser.newPage({ viewport: { width, height }, colorScheme: 'light' });
  await page.goto(pathToFileURL(file).href);
  await page.waitForFunction(() => document.documentElement.dataset.ready);
  return page;
}

const choose = (page, name, seconds, view) =>
  page.evaluate(
    ([clip, time, options]) => {
      const { data, player } = window.nmcReport;
      for (const [id, value] of Object.entries(options)) {
        const field = document.getElementById(id);
        field.value = value;
        field.dispatchEvent(new Event('change'));
      }
      player.choose(data.clips.find((one) => one.name === clip));
      player.seek(time);
      return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    },
    [name, seconds, view],
  );

const tolerances = ['0.1%', '0.5%', '1%', '2%'];
const reports = new Map(tolerances.map((tolerance) => [tolerance, reportAt(tolerance)]));

// The report itself, as it opens.
const page = await open(reports.get('0.1%'), 1120, 1000);
await choose(page, 'run', 0.21, { layout: 'side', show: 'both' });
await page.evaluate(() => document.getElementById('player-title').scrollIntoView());
await page.locator('#player .player').screenshot({ path: join(here, 'player.png') });
for (const name of ['error', 'spectrum', 'candidates']) await page.locator(`figure:has(#${name}-chart)`).screenshot({ path: join(here, `${name}.png`) });
await page.close();

// The same moment at each tolerance: the skin with its error, each in units of its own tolerance, over the original.
for (const [tolerance, file] of reports) {
  const one = await open(file, 420, 844);
  await choose(one, 'run', 0.21, { layout: 'over', show: 'both' });
  await one.locator('#stage').screenshot({ path: join(here, `tolerance_${tolerance.replace('%', '')}.png`) });
  await one.close();
}
await browser.close();
