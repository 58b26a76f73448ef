/** The headless browser in which the pictures are drawn. */
import { chromium } from '@playwright/test';

// Drawn in software, pictures are the same with any graphics card, or none.
export const launch = () =>
  chromium.launch({
    executablePath: process.env.CHROMIUM_PATH ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  });
