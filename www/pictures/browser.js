/** The headless browser in which the pictures are drawn. */
import { chromium } from '@playwright/test';

export const launch = () =>
  chromium.launch({ executablePath: process.env.CHROMIUM_PATH ?? '/usr/bin/chromium', args: ['--no-sandbox'] });
