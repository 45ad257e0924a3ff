#!/usr/bin/env node
import "taotie-wasm/cli";
